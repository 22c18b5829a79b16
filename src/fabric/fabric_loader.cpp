#include <filesystem>
#include <string>

#include "fabric/fabric_laws.h"
#include "fabric/yaml_reader.h"
#include "haptic_cloth/fabric.h"

namespace haptic_cloth {
namespace {

// How far linear laws are sampled: about what KES measures, as powers of two (see linearLoading).
constexpr double kLinearStrain = 1.0 / 16.0;  ///< [-]
constexpr double kLinearCurvature = 256.0;    ///< [1/m]
constexpr double kLinearShear = 1.0 / 8.0;    ///< [rad]

double positive(const YamlValue& value) {
  const double number = value.number();
  if (!(number > 0.0)) value.fail("must be > 0");
  return number;
}

double notNegative(const YamlValue& value) {
  const double number = value.number();
  if (!(number >= 0.0)) value.fail("must be >= 0");
  return number;
}

void checkNotNegative(const YamlMap& map, const std::string& name) {
  if (const auto value = map.find(name)) notNegative(*value);
}

std::vector<TableRow> readRows(const YamlValue& table) {
  const std::vector<YamlValue> entries = table.list();
  if (entries.size() < 2) table.fail("must have at least two rows");
  std::vector<TableRow> rows;
  for (const YamlValue& entry : entries) {
    const auto [deformation, force] = entry.numbers<2>();
    if (!rows.empty() && deformation <= rows.back().deformation) {
      entry.fail("the first column must increase strictly from row to row");
    }
    if (!rows.empty() && force < rows.back().force) {
      entry.fail("the second column (the force) must not decrease from row to row");
    }
    rows.push_back({deformation, force});
  }
  return rows;
}

void checkUnloading(const YamlValue& table, const std::vector<TableRow>& loading) {
  const std::vector<TableRow> rows = readRows(table);
  const std::vector<YamlValue> entries = table.list();
  // Room for rounding where both tables share their last row.
  const double slack = 1e-9 * loading.back().force;
  for (std::size_t i = 0; i < rows.size(); ++i) {
    if (rows[i].deformation < 0.0 || rows[i].deformation > loading.back().deformation) {
      entries[i].fail("the first column must stay within that of loading");
    }
    if (rows[i].force > interpolate(loading, rows[i].deformation) + slack) {
      entries[i].fail("unloading must not lie above loading");
    }
  }
}

Loading readTables(const YamlMap& map) {
  const YamlValue table = map.require("loading", "is required beside unloading");
  const std::vector<TableRow> rows = readRows(table);
  if (rows.front().deformation != 0.0 || rows.front().force != 0.0) {
    table.list().front().fail("the first row must be [0, 0]");
  }
  if (const auto unloading = map.find("unloading")) checkUnloading(*unloading, rows);
  return tableLoading(rows);
}

/// What a law may be written as.
enum class LawKind { Kes, Linear, Table };

/// The three ways to write one law: its KES keys (the first one required), or `linear`, or tables.
struct LawKeys {
  std::vector<std::string> kes;
  std::string linear;
};

const LawKeys kTensileKeys{{"EMT", "LT", "RT"}, "stiffness"};
const LawKeys kBendingKeys{{"B", "2HB"}, "rigidity"};
const LawKeys kShearKeys{{"G", "2HG", "2HG5"}, "modulus"};

std::vector<std::string> allKeys(const LawKeys& keys) {
  std::vector<std::string> all = keys.kes;
  all.insert(all.end(), {keys.linear, "loading", "unloading"});
  return all;
}

LawKind lawKind(const YamlMap& map, const LawKeys& keys) {
  bool has_kes = false;
  for (const std::string& key : keys.kes) has_kes = has_kes || map.find(key).has_value();
  const bool has_linear = map.find(keys.linear).has_value();
  const bool has_table = map.find("loading") || map.find("unloading");
  if (static_cast<int>(has_kes) + static_cast<int>(has_linear) + static_cast<int>(has_table) != 1) {
    map.value().fail("must have exactly one of: KES parameters (" + joined(keys.kes) + "), " + keys.linear +
                     ", or tables (loading, unloading)");
  }
  return has_kes ? LawKind::Kes : has_linear ? LawKind::Linear : LawKind::Table;
}

Loading readTensileLaw(const YamlMap& map) {
  switch (lawKind(map, kTensileKeys)) {
    case LawKind::Kes: {
      const double emt = positive(map.require("EMT"));
      const double linearity = positive(map.require("LT"));
      if (linearity > 1.0) map.require("LT").fail("must be > 0 and <= 1");
      if (const auto resilience = map.find("RT")) {
        if (const double rt = resilience->number(); !(rt > 0.0 && rt <= 100.0)) {
          resilience->fail("must be > 0 and <= 100");
        }
      }
      return kesTensile(emt / 100.0, linearity);
    }
    case LawKind::Linear:
      return linearLoading(positive(map.require("stiffness")), kLinearStrain);
    case LawKind::Table:
      break;
  }
  const Loading loading = readTables(map);
  if (!(loading.forces.back() > 0.0)) map.require("loading").fail("the last force must be > 0");
  return loading;
}

Loading readBendingLaw(const YamlMap& map) {
  switch (lawKind(map, kBendingKeys)) {
    case LawKind::Kes:
      checkNotNegative(map, "2HB");
      return linearLoading(kes::kBendingRigidity * notNegative(map.require("B")), kLinearCurvature);
    case LawKind::Linear:
      return linearLoading(notNegative(map.require("rigidity")), kLinearCurvature);
    case LawKind::Table:
      break;
  }
  return readTables(map);
}

Loading readShearLaw(const YamlMap& map) {
  switch (lawKind(map, kShearKeys)) {
    case LawKind::Kes:
      checkNotNegative(map, "2HG");
      checkNotNegative(map, "2HG5");
      return linearLoading(kes::kShearModulus * notNegative(map.require("G")), kLinearShear);
    case LawKind::Linear:
      return linearLoading(notNegative(map.require("modulus")), kLinearShear);
    case LawKind::Table:
      break;
  }
  return readTables(map);
}

void checkBias(const YamlValue& bias) { notNegative(YamlMap(bias, {"B"}).require("B")); }

/// The laws of warp and weft; the same one twice where the file gives one for both.
struct Group {
  Loading warp;
  Loading weft;
  bool apart;
};

/// One law for both directions, or `warp` and `weft` apart. @param bias whether a `bias` entry may stand here
template <class ReadLaw>
Group readGroup(const YamlValue& group, const LawKeys& keys, bool bias, ReadLaw read_law) {
  std::vector<std::string> known = allKeys(keys);
  if (bias) known.emplace_back("bias");
  std::vector<std::string> known_apart = known;
  known_apart.insert(known_apart.end(), {"warp", "weft"});
  const YamlMap either(group, known_apart);
  if (bias && either.find("bias")) checkBias(*either.find("bias"));

  if (!either.find("warp") && !either.find("weft")) {
    const Loading law = read_law(YamlMap(group, known));
    return {law, law, false};
  }
  for (const std::string& key : allKeys(keys)) {
    if (const auto beside = either.find(key)) beside->fail("must not stand beside warp and weft");
  }
  const YamlValue warp = either.require("warp", "is required beside weft");
  const YamlValue weft = either.require("weft", "is required beside warp");
  return {read_law(YamlMap(warp, allKeys(keys))), read_law(YamlMap(weft, allKeys(keys))), true};
}

void readAssumed(const YamlMap& map, std::vector<std::string>& assumed) {
  const std::vector<std::string> groups{"areal_density", "thickness", "tensile",
                                        "bending",       "shear",     "compression_ratio"};
  std::vector<std::pair<std::string, std::string>> choices;
  for (const std::string& group : groups) choices.emplace_back(group, group);
  if (const auto list = map.find("assumed")) {
    for (const YamlValue& entry : list->list()) assumed.push_back(entry.choice(choices));
  }
}

Fabric readFabric(const YamlMap& map, const std::string& default_name) {
  Fabric fabric;
  fabric.name = default_name;
  if (const auto name = map.find("name")) fabric.name = name->text();
  fabric.source = map.require("source", "is required: where the numbers come from").text();
  readAssumed(map, fabric.assumed);
  fabric.areal_density = positive(map.require("areal_density"));
  fabric.thickness = positive(map.require("thickness"));
  if (const auto ratio = map.find("compression_ratio")) fabric.compression_ratio = notNegative(*ratio);

  const Group tensile = readGroup(map.require("tensile"), kTensileKeys, false, readTensileLaw);
  fabric.tensile = {tensileCurve(tensile.warp, fabric.compression_ratio),
                    tensileCurve(tensile.weft, fabric.compression_ratio)};
  if (const auto group = map.find("bending")) {
    const Group bending = readGroup(*group, kBendingKeys, true, readBendingLaw);
    fabric.bending = {oddCurve(bending.warp), oddCurve(bending.weft)};
  }
  if (const auto group = map.find("shear")) {
    const Group shear = readGroup(*group, kShearKeys, false, readShearLaw);
    fabric.shear = oddCurve(shear.apart ? meanLoading(shear.warp, shear.weft) : shear.warp);
  }
  return fabric;
}

}  // namespace

Fabric loadFabric(const std::string& file) {
  const YamlDocument document = YamlDocument::fromFile(file);
  const YamlMap map(document.root(), {"name", "source", "assumed", "areal_density", "thickness", "tensile",
                                      "bending", "shear", "compression_ratio"});
  return readFabric(map, std::filesystem::path(file).stem().string());
}

}  // namespace haptic_cloth
