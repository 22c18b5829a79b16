#include <cmath>
#include <filesystem>
#include <locale>
#include <optional>
#include <sstream>
#include <string>

#include "fabric/fabric_laws.h"
#include "fabric/fabric_limits.h"
#include "fabric/yaml_reader.h"
#include "haptic_cloth/fabric.h"
#include "state/number_text.h"

namespace haptic_cloth {
namespace {

// Range in which linear laws are sampled: about that of KES, in powers of two (see linearLaw()).
constexpr double kLinearStrain = 1.0 / 16.0;  ///< [-]
constexpr double kLinearCurvature = 256.0;    ///< [1/m]
constexpr double kLinearShear = 1.0 / 8.0;    ///< [rad]

/// Limits within which no product or quotient of a law overflows. Measured values are far from
/// them.
constexpr double kSmallest = 1e-12, kLargest = 1e12;

double bounded(const YamlValue& value) {
  const double number = value.number();
  if (std::abs(number) > kLargest) value.fail("must be within -1e12 to 1e12");
  return number;
}

double positive(const YamlValue& value) {
  const double number = bounded(value);
  if (!(number > 0.0)) value.fail("must be > 0");
  if (number < kSmallest) value.fail("must be at least 1e-12");
  return number;
}

// Limits of KES quantities, like those of fabric_limits.h.
constexpr double kLeastStretch = 0.1;         ///< EMT [%]; fabrics have 0.5 to 50, as a fraction 0.005 to 0.5
constexpr double kLeastLinearTension = 0.05;  ///< LT [-]; fabrics have 0.4 to 1
constexpr double kLeastShareBack = 4.0;       ///< RT LT [%]: with it, exponents of 50 at most
constexpr double kLeastResilience = 1;        ///< RT [%]; fabrics have 30 to 95, as a fraction up to 1

double positiveUpTo(const YamlValue& value, double most, const char* rule) {
  const double number = positive(value);
  if (number > most) value.fail(rule);
  return number;
}

double notNegative(const YamlValue& value) {
  const double number = bounded(value);
  if (!(number >= 0.0)) value.fail("must be >= 0");
  return number;
}

double notNegativeOr(const YamlMap& map, const std::string& name, double missing) {
  const auto value = map.find(name);
  return value ? notNegative(*value) : missing;
}

/// Number as text, with a point in every locale.
std::string plain(double number) {
  std::ostringstream text;
  text.imbue(std::locale::classic());
  text << number;
  return text.str();
}

std::vector<TableRow> readRows(const YamlValue& table) {
  const std::vector<YamlValue> entries = table.list();
  if (entries.size() < 2) table.fail("must have at least two rows");
  std::vector<TableRow> rows;
  for (const YamlValue& entry : entries) {
    const std::vector<YamlValue> row = entry.list(2, "numbers");
    const double deformation = bounded(row[0]), force = bounded(row[1]);
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

/// Reads unloading rows and completes them to the range of loading: the force is constant below the
/// first row, and the last row is joined to the end of loading.
std::vector<TableRow> readUnloading(const YamlValue& table, const std::vector<TableRow>& loading) {
  std::vector<TableRow> rows = readRows(table);
  const std::vector<YamlValue> entries = table.list();
  // Allows for rounding if both tables share their last row.
  const double slack = 1e-9 * loading.back().force;
  for (std::size_t i = 0; i < rows.size(); ++i) {
    if (rows[i].deformation < 0.0 || rows[i].deformation > loading.back().deformation) {
      entries[i].fail("the first column must stay within that of loading");
    }
    if (rows[i].force > interpolate(loading, rows[i].deformation) + slack) {
      entries[i].fail("unloading must not lie above loading");
    }
  }
  if (rows.front().deformation > 0.0) rows.insert(rows.begin(), {0.0, rows.front().force});
  if (rows.back().deformation < loading.back().deformation) rows.push_back(loading.back());
  for (const TableRow& row : loading) {
    if (interpolate(rows, row.deformation) > row.force + slack) {
      table.fail("unloading must not lie above loading, as it does at " + plain(row.deformation));
    }
  }
  return rows;
}

/// @param through_zero the law is not odd, so its force starts at zero
HalfLoop readTables(const YamlMap& map, bool through_zero) {
  const YamlValue table = map.require("loading", "is required beside unloading");
  const std::vector<TableRow> rows = readRows(table);
  if (rows.back().deformation < kSmallest) table.list().back().fail("must end at 1e-12 at least");
  const auto other = map.find("unloading");
  const TableRow& first = rows.front();
  if (first.deformation != 0.0 || first.force < 0.0 || ((through_zero || !other) && first.force != 0.0)) {
    table.list().front().fail(through_zero || !other ? "the first row must be [0, 0]"
                                                     : "the first row must be [0, force >= 0]");
  }
  if (!other) return tableLaw(rows, {});
  const std::vector<TableRow> unloading = readUnloading(*other, rows);
  if (through_zero && unloading.front().force != 0.0) {
    other->list().front().fail("the first force must be 0: a tensile loop closes there");
  }
  return tableLaw(rows, unloading);
}

/// Form in which a law is written.
enum class LawKind { Kes, Linear, Table };

/// Keys of one law in its three forms: its KES keys (the first one is required), `linear`, or
/// tables.
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

HalfLoop readTensileLaw(const YamlMap& map) {
  switch (lawKind(map, kTensileKeys)) {
    case LawKind::Kes: {
      const double emt = positive(map.require("EMT"));
      if (emt < kLeastStretch) map.require("EMT").fail("must be at least 0.1: it is in %");
      const double linearity = positive(map.require("LT"));
      if (linearity < kLeastLinearTension || linearity > 1.0)
        map.require("LT").fail("must be within 0.05 to 1");
      double resilience = 100.0;
      if (const auto value = map.find("RT")) {
        resilience = value->number();
        if (!(resilience > kLeastResilience && resilience <= 100.0))
          value->fail("must be > 1 and <= 100: it is in %");
        if (resilience * linearity < kLeastShareBack)
          value->fail("must be at least " + shortestText(kLeastShareBack / linearity) +
                      " (4/LT): the samples of the law resolve no steeper unloading");
      }
      return kesTensile(emt / 100.0, linearity, resilience / 100.0);
    }
    case LawKind::Linear:
      return linearLaw(positive(map.require("stiffness")), kLinearStrain);
    case LawKind::Table:
      break;
  }
  const HalfLoop law = readTables(map, true);
  if (!(law.loading.back() > 0.0)) map.require("loading").fail("the last force must be > 0");
  return law;
}

HalfLoop readBendingLaw(const YamlMap& map) {
  switch (lawKind(map, kBendingKeys)) {
    case LawKind::Kes:
      return kesBending(kes::kBendingRigidity * notNegative(map.require("B")),
                        0.5 * kes::kHysteresisOfBending * notNegativeOr(map, "2HB", 0.0));
    case LawKind::Linear:
      return linearLaw(notNegative(map.require("rigidity")), kLinearCurvature);
    case LawKind::Table:
      break;
  }
  return readTables(map, false);
}

HalfLoop readKesShear(const YamlMap& map) {
  const double modulus = notNegative(map.require("G"));
  const double narrow = notNegativeOr(map, "2HG", notNegativeOr(map, "2HG5", 0.0));
  const double wide = notNegativeOr(map, "2HG5", narrow);
  // Both branches must rise, and the loop must be open at zero and still at 8°, where the law ends.
  if (std::abs(wide - narrow) > 9.0 * modulus || wide > 10.0 * narrow || wide < 0.4 * narrow) {
    map.require("2HG5").fail("must differ from 2HG by at most 9 G and be 0.4 to 10 times 2HG");
  }
  return kesShear(kes::kShearModulus * modulus, 0.5 * kes::kForcePerWidth * narrow,
                  0.5 * kes::kForcePerWidth * wide);
}

HalfLoop readShearLaw(const YamlMap& map) {
  switch (lawKind(map, kShearKeys)) {
    case LawKind::Kes:
      return readKesShear(map);
    case LawKind::Linear:
      return linearLaw(notNegative(map.require("modulus")), kLinearShear);
    case LawKind::Table:
      break;
  }
  return readTables(map, false);
}

/// Reads KES-FB3 data: thickness where the pressure begins and at 50 gf/cm², linearity, and for a
/// check the work and the resilience.
/// @param fabric_thickness [m]
Compression readCompression(const YamlValue& group, double fabric_thickness) {
  const YamlMap map(group, {"T0", "Tm", "LC", "WC", "RC"});
  constexpr double kMillimetre = 1e-3;
  const YamlValue given = map.require("T0");
  const double thickness = positiveUpTo(given, kThickest / kMillimetre, "must be at most 50: it is in mm"),
               pressed = positive(map.require("Tm")), ratio = kMillimetre * thickness / fabric_thickness;
  if (!(ratio <= kAlike && ratio >= 1.0 / kAlike))
    given.fail("must be within a factor of 10 of thickness = " + plain(fabric_thickness / kMillimetre) +
               " mm: it is in mm");
  if (!(pressed <= kMostPressed * thickness)) map.require("Tm").fail("must be at most 0.99 T0");
  const double linearity = map.require("LC").number();
  if (!(linearity >= kLeastLinearity && linearity < 1.0)) map.require("LC").fail("must be >= 0.05 and < 1");
  if (const auto work = map.find("WC")) {
    // LC is defined by WC = LC P_m (T0 - Tm)/2; 50 gf/cm² · 1 mm = 5 gf·cm/cm². Sources round.
    constexpr double kRounding = 0.05;
    const double expected = linearity * 5.0 * (thickness - pressed) / 2.0;
    if (std::abs(positive(*work) - expected) > kRounding * expected) {
      work->fail("must be 2.5 LC (T0 - Tm) within 5 %, " + plain(expected) + ": it is in gf·cm/cm²");
    }
  }
  if (const auto resilience = map.find("RC")) {
    if (const double value = resilience->number(); !(value > kLeastResilience && value <= 100.0))
      resilience->fail("must be > 1 and <= 100: it is in %");
  }
  return {kMillimetre * thickness, kMillimetre * pressed, linearity};
}

/// Laws of warp and weft; equal if the file gives one for both.
struct Group {
  HalfLoop warp;
  HalfLoop weft;
  bool apart;
  std::optional<YamlValue> bias;
};

/// Reads one law for both directions, or separate ones for `warp` and `weft`.
/// @param bias whether a `bias` entry is allowed
template <class ReadLaw>
Group readGroup(const YamlValue& group, const LawKeys& keys, bool bias, ReadLaw read_law) {
  std::vector<std::string> known = allKeys(keys);
  if (bias) known.emplace_back("bias");
  std::vector<std::string> known_apart = known;
  known_apart.insert(known_apart.end(), {"warp", "weft"});
  const YamlMap either(group, known_apart);
  const std::optional<YamlValue> bias_value = bias ? either.find("bias") : std::nullopt;

  if (!either.find("warp") && !either.find("weft")) {
    const HalfLoop law = read_law(YamlMap(group, known));
    return {law, law, false, bias_value};
  }
  for (const std::string& key : allKeys(keys)) {
    if (const auto beside = either.find(key)) beside->fail("must not stand beside warp and weft");
  }
  const YamlValue warp = either.require("warp", "is required beside weft");
  const YamlValue weft = either.require("weft", "is required beside warp");
  return {read_law(YamlMap(warp, allKeys(keys))), read_law(YamlMap(weft, allKeys(keys))), true, bias_value};
}

/// Computes B_t of the twist term from the rigidity on the bias: B_45 = (B_warp + B_weft)/4 +
/// B_t/2.
double twistRigidity(const Group& bending) {
  if (!bending.bias) return 0.0;
  const auto rigidity = [](const HalfLoop& half) {
    return (half.loading.back() - half.loading.front()) / half.end();
  };
  const YamlMap map(*bending.bias, {"B"});
  const double bias = kes::kBendingRigidity * notNegative(map.require("B"));
  const double twist = 2.0 * bias - 0.5 * (rigidity(bending.warp) + rigidity(bending.weft));
  if (twist < 0.0) {
    map.require("B").fail(
        "must be at least (B_warp + B_weft)/4: so much do warp and weft alone give on the bias");
  }
  return twist;
}

void readAssumed(const YamlMap& map, std::vector<std::string>& assumed) {
  const std::vector<std::string> groups{"areal_density", "thickness",   "tensile",          "bending",
                                        "shear",         "compression", "compression_ratio"};
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
  fabric.areal_density = positiveUpTo(map.require("areal_density"), kHeaviest, kHeaviestRule);
  fabric.thickness = positiveUpTo(map.require("thickness"), kThickest, kThickestRule);
  if (const auto ratio = map.find("compression_ratio")) fabric.compression_ratio = notNegative(*ratio);

  const Group tensile = readGroup(map.require("tensile"), kTensileKeys, false, readTensileLaw);
  fabric.tensile = {tensileLoop(tensile.warp, fabric.compression_ratio),
                    tensileLoop(tensile.weft, fabric.compression_ratio)};
  if (const auto group = map.find("bending")) {
    const Group bending = readGroup(*group, kBendingKeys, true, readBendingLaw);
    fabric.bending = {oddLoop(bending.warp), oddLoop(bending.weft)};
    fabric.twist_rigidity = twistRigidity(bending);
  }
  if (const auto group = map.find("shear")) {
    const Group shear = readGroup(*group, kShearKeys, false, readShearLaw);
    fabric.shear = oddLoop(shear.apart ? meanLaw(shear.warp, shear.weft) : shear.warp);
  }
  if (const auto group = map.find("compression"))
    fabric.compression = readCompression(*group, fabric.thickness);
  return fabric;
}

Fabric readFabric(const YamlDocument& document, const std::string& default_name) {
  const YamlMap map(document.root(), {"name", "source", "assumed", "areal_density", "thickness", "tensile",
                                      "bending", "shear", "compression", "compression_ratio"});
  return readFabric(map, default_name);
}

}  // namespace

Fabric loadFabric(const std::string& file) {
  return readFabric(YamlDocument::fromFile(file), std::filesystem::path(file).stem().string());
}

Fabric parseFabric(const std::string& yaml, const std::string& origin, const std::string& name) {
  return readFabric(YamlDocument::fromText(yaml, origin), name);
}

}  // namespace haptic_cloth
