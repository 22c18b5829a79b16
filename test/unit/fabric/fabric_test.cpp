/// Fabric files: laws in SI units, and messages with file, key, value and rule for every error.
#include "haptic_cloth/fabric.h"

#include <gtest/gtest.h>
#include <unistd.h>

#include <algorithm>
#include <cmath>
#include <cstdlib>
#include <filesystem>
#include <fstream>
#include <string>
#include <vector>

#include "fabric/fabric_search.h"
#include "haptic_cloth/error.h"
#include "haptic_cloth/types.h"

namespace haptic_cloth::fabric_test {
namespace {

namespace fs = std::filesystem;

constexpr char kHead[] = "source: test\nareal_density: 0.2\nthickness: 0.0005\n";
constexpr char kTensile[] = "tensile: {stiffness: 1000}\n";

class FabricFile : public ::testing::Test {
 protected:
  void SetUp() override {
    const auto* info = ::testing::UnitTest::GetInstance()->current_test_info();
    directory_ = fs::temp_directory_path() /
                 ("haptic_cloth_fabric_" + std::string(info->name()) + "_" + std::to_string(getpid()));
    fs::create_directories(directory_);
  }
  void TearDown() override { fs::remove_all(directory_); }

  std::string write(const std::string& text, const std::string& name = "cloth.yaml") const {
    const std::string file = (directory_ / name).string();
    std::ofstream(file) << text;
    return file;
  }

  Fabric load(const std::string& text) const { return loadFabric(write(text)); }

  /// Message of the error when `text` is loaded, without the directory; "" if it loads.
  std::string message(const std::string& text) const {
    try {
      load(text);
    } catch (const InputError& error) {
      const std::string what = error.what();
      EXPECT_EQ(what.find('\n'), std::string::npos) << what;
      return what.substr(what.find("cloth.yaml"));
    }
    return {};
  }

  struct Case {
    std::string text, expected;
  };
  void expectMessages(const std::vector<Case>& cases) const {
    for (const Case& one : cases) EXPECT_EQ(message(one.text), one.expected) << one.text;
  }

  fs::path directory_;
};

TEST_F(FabricFile, KesParametersBecomeSi) {
  const Fabric fabric = load(std::string(kHead) +
                             "tensile: {EMT: 6.03, LT: 0.608, RT: 62.19}\n"
                             "bending: {warp: {B: 0.1357, 2HB: 0.0622}, weft: {B: 0.2, 2HB: 0}}\n"
                             "shear: {G: 0.9676, 2HG: 1.204, 2HG5: 2.567}\n");
  EXPECT_EQ(fabric.name, "cloth");
  EXPECT_DOUBLE_EQ(fabric.areal_density, 0.2);
  // 500 gf/cm at EMT; 1 gf·cm²/cm = 9.80665e-5 N·m, 1 gf/(cm·deg) = 56.18797 N/m.
  EXPECT_NEAR(fabric.tensile[kWarp].upper()(0.0603).force, 490.3325, 1e-9);
  EXPECT_NEAR(fabric.bending[kWarp].upper()(10.0).force, 0.1357 * 9.80665e-4 + 0.5 * 0.0622 * 9.80665e-3,
              1e-15);
  EXPECT_NEAR(fabric.bending[kWeft].upper()(-10.0).force, -0.2 * 9.80665e-4, 1e-15);
  // Half the width of the loop is ½ (2HG + (2HG5 - 2HG)(|φ| - 0.5°)/4.5°) · 0.980665 N/m.
  const double half_width = 0.5 * 0.980665 * (1.204 + (2.567 - 1.204) * (0.1 * 57.29577951 - 0.5) / 4.5);
  EXPECT_NEAR(fabric.shear.upper()(0.1).force, 0.9676 * 5.618797 + half_width, 1e-6);
  EXPECT_TRUE(fabric.bending[kWarp].hasMemory() && fabric.shear.hasMemory() &&
              fabric.tensile[kWeft].hasMemory());
  EXPECT_FALSE(fabric.bending[kWeft].hasMemory());
  EXPECT_EQ(fabric.bending[kWeft].upper()(0.0).force, 0.0);
}

TEST_F(FabricFile, KesTensileLoopGivesBackTheResilience) {
  // By definition RT = work returned / work done between 0 and EMT.
  const Loop loop = load(std::string(kHead) + "tensile: {EMT: 6.03, LT: 0.608, RT: 62.19}\n").tensile[kWarp];
  double play = loop.initialPlay(), s = 0.0, done = 0.0, given_back = 0.0;
  const auto go = [&](double to) {
    double work = 0.0;
    for (int k = 1; k <= 4000; ++k) {
      const double next = s + (to - s) / (4001 - k);
      const Loop::Step step = loop.begin(play);
      work += loop(step, next).potential - loop(step, s).potential;
      play = loop.commit(play, next);
      s = next;
    }
    return work;
  };
  done = go(0.0603);
  given_back = -go(0.0);
  EXPECT_NEAR(done / (0.5 * 490.3325 * 0.0603), 0.608, 1e-3);
  EXPECT_NEAR(given_back / done, 0.6219, 1e-3);
  EXPECT_NEAR(loop.force(play, s), 0.0, 1e-6);
}

TEST_F(FabricFile, CompressionDataBecomeSi) {
  const std::string base = std::string(kHead) + kTensile;
  EXPECT_FALSE(load(base).compression.has_value());
  // WC = 2.5 · 0.33 · 0.25 = 0.206 gf·cm/cm², rounded as sources do.
  for (const std::string rest : {"", ", WC: 0.21, RC: 55"}) {
    const Fabric fabric = load(base + "compression: {T0: 0.90, Tm: 0.65, LC: 0.33" + rest + "}\n");
    ASSERT_TRUE(fabric.compression.has_value());
    EXPECT_DOUBLE_EQ(fabric.compression->thickness, 0.9e-3);
    EXPECT_DOUBLE_EQ(fabric.compression->pressed_thickness, 0.65e-3);
    EXPECT_EQ(fabric.compression->linearity, 0.33);
  }
}

TEST_F(FabricFile, WrongCompressionDataAreNamed) {
  const std::string base = std::string(kHead) + kTensile;
  expectMessages({
      {base + "compression: {Tm: 0.65, LC: 0.33}\n", "cloth.yaml:5: compression.T0: is required"},
      {base + "compression: {T0: 900, Tm: 650, LC: 0.33}\n",
       "cloth.yaml:5: compression.T0 = 900: must be at most 50: it is in mm"},
      {base + "compression: {T0: 0.0009, Tm: 0.00065, LC: 0.33}\n",
       "cloth.yaml:5: compression.T0 = 0.0009: must be within a factor of 10 of thickness = 0.5 mm: it is in "
       "mm"},
      {base + "compression: {T0: 0.65, Tm: 0.9, LC: 0.33}\n",
       "cloth.yaml:5: compression.Tm = 0.9: must be at most 0.99 T0"},
      {base + "compression: {T0: 0.9, Tm: 0.892, LC: 0.33}\n",
       "cloth.yaml:5: compression.Tm = 0.892: must be at most 0.99 T0"},
      {base + "compression: {T0: 0.9, Tm: 0.65, LC: 1}\n",
       "cloth.yaml:5: compression.LC = 1: must be >= 0.05 and < 1"},
      {base + "compression: {T0: 0.9, Tm: 0.65, LC: 0.049}\n",
       "cloth.yaml:5: compression.LC = 0.049: must be >= 0.05 and < 1"},
      {base + "compression: {T0: 0.9, Tm: 0.65, LC: 0.33, WC: 0.23}\n",
       "cloth.yaml:5: compression.WC = 0.23: must be 2.5 LC (T0 - Tm) within 5 %, 0.20625: it is in "
       "gf·cm/cm²"},
      {base + "compression: {T0: 0.9, Tm: 0.65, LC: 0.33, RC: 0.5}\n",
       "cloth.yaml:5: compression.RC = 0.5: must be > 1 and <= 100: it is in %"},
      {base + "compression: {T: 0.9}\n",
       "cloth.yaml:5: compression.T: unknown key; known here: T0, Tm, LC, WC, RC"},
  });
}

TEST_F(FabricFile, TwistMakesUpWhatTheBiasHasMore) {
  // B_45 = (B_warp + B_weft)/4 + B_t/2.
  const Fabric fabric =
      load(std::string(kHead) + kTensile + "bending: {warp: {B: 0.1}, weft: {B: 0.2}, bias: {B: 0.12}}\n");
  EXPECT_NEAR(fabric.twist_rigidity, 2.0 * (0.12 - 0.3 / 4.0) * 9.80665e-5, 1e-15);
  EXPECT_EQ(load(std::string(kHead) + kTensile + "bending: {B: 0.1}\n").twist_rigidity, 0.0);
}

TEST_F(FabricFile, KesTensileCurveHasTheGivenLinearity) {
  // By definition LT = ∫F dε / (½ F_m EMT); the trapezium rule on 512 intervals has an error of
  // about 1e-6.
  const Curve tensile = load(std::string(kHead) + "tensile: {EMT: 5, LT: 0.7}\n").tensile[kWarp].upper();
  EXPECT_NEAR(tensile(0.05).potential / (0.5 * 490.3325 * 0.05), 0.7, 1e-5);
  // T = F_m (ε/ε_m)^n; between nodes to second order of the interval.
  EXPECT_NEAR(tensile(0.0123).force, 490.3325 * std::pow(0.0123 / 0.05, 2.0 / 0.7 - 1.0), 1e-3);
  // The law is linear beyond the end, with the slope at the end.
  EXPECT_DOUBLE_EQ(tensile(0.06).slope, tensile(0.0499999).slope);
  EXPECT_NEAR(tensile(0.06).slope, 490.3325 / 0.05 * (2.0 / 0.7 - 1.0), 30.0);
}

TEST_F(FabricFile, CompressionIsLinearWithTheGivenShareOfTheStiffnessAtOnePercent) {
  const Fabric fabric = load(std::string(kHead) + "tensile: {EMT: 6, LT: 0.6}\ncompression_ratio: 0.25\n");
  const double n = 2.0 / 0.6 - 1.0;
  const double tangent = 490.3325 / 0.06 * n * std::pow(0.01 / 0.06, n - 1.0);
  EXPECT_NEAR(fabric.tensile[kWarp].upper()(-0.02).slope, 0.25 * tangent, 1e-3 * tangent);
  EXPECT_NEAR(fabric.tensile[kWarp].upper()(-0.02).force, -0.02 * 0.25 * tangent, 1e-4 * tangent);
  EXPECT_EQ(fabric.tensile[kWarp].upper()(0.0).force, 0.0);
  EXPECT_EQ(fabric.tensile[kWarp].upper()(0.0).potential, 0.0);
}

TEST_F(FabricFile, FabricThatExtendsFarIsNotWithoutStiffnessInCompression) {
  // docs/model.md: at least a fifth of F_m/ε_m counts. The slope at 1 % is 0.2 % of that here.
  const Fabric fabric = load(std::string(kHead) + "tensile: {EMT: 40, LT: 0.5}\ncompression_ratio: 0.25\n");
  const double secant = 490.3325 / 0.4;
  EXPECT_NEAR(fabric.tensile[kWarp].upper()(-0.02).slope, 0.25 * 0.2 * secant, 1e-9 * secant);
}

TEST_F(FabricFile, LinearLaws) {
  const Fabric fabric = load(std::string(kHead) +
                             "tensile: {warp: {stiffness: 1000}, weft: {stiffness: 500}}\n"
                             "bending: {rigidity: 1.0e-5}\nshear: {modulus: 30}\n");
  EXPECT_DOUBLE_EQ(fabric.tensile[kWarp].upper()(0.3).slope, 1000.0);
  EXPECT_DOUBLE_EQ(fabric.tensile[kWeft].upper()(0.3).force, 150.0);
  EXPECT_DOUBLE_EQ(fabric.tensile[kWarp].upper()(-0.1).force, -10.0);
  EXPECT_DOUBLE_EQ(fabric.bending[kWarp].upper()(-1000.0).force, -0.01);
  EXPECT_DOUBLE_EQ(fabric.shear.upper()(0.5).force, 15.0);
}

TEST_F(FabricFile, TablesKeepEquallySpacedRowsAndAreOddForBending) {
  const Fabric fabric = load(std::string(kHead) +
                             "tensile: {loading: [[0, 0], [0.01, 5], [0.02, 20], [0.03, 60]], "
                             "unloading: [[0.02, 0], [0.03, 60]]}\n"
                             "bending: {loading: [[0, 0], [100, 2.0e-3], [250, 3.0e-3]]}\n");
  EXPECT_NEAR(fabric.tensile[kWarp].upper()(0.01).force, 5.0, 1e-9);
  EXPECT_NEAR(fabric.tensile[kWarp].upper()(0.025).force, 40.0, 1e-9);
  EXPECT_NEAR(fabric.tensile[kWarp].upper()(0.04).force, 100.0, 1e-9);
  // The tangent at 1 % is the mean of 500 and 1500 N/m.
  EXPECT_NEAR(fabric.tensile[kWarp].upper()(-0.01).slope, 100.0, 1e-6);
  EXPECT_NEAR(fabric.bending[kWeft].upper()(200.0).force, 3.0e-3 - 50.0e-3 / 150.0, 1e-12);
  EXPECT_NEAR(fabric.bending[kWeft].upper()(-200.0).force, -fabric.bending[kWeft].upper()(200.0).force,
              1e-15);
  EXPECT_EQ(fabric.bending[kWeft].upper()(0.0).force, 0.0);
}

TEST_F(FabricFile, ShearMeasuredInBothDirectionsIsAveraged) {
  const Fabric fabric =
      load(std::string(kHead) + kTensile + "shear: {warp: {modulus: 20}, weft: {modulus: 40}}\n");
  EXPECT_NEAR(fabric.shear.upper()(0.07).force, 2.1, 1e-12);
}

TEST_F(FabricFile, MeanOfShearLawsOfDifferentRangeIsALoop) {
  // Loops that close at their end, or would cross beyond it, and a law that goes on.
  const std::string closing =
      "{loading: [[0, 0], [0.025, 6], [0.05, 8]], unloading: [[0, 0], [0.04, 2], [0.05, 8]]}";
  const std::string elastic = "{loading: [[0, 0], [0.3, 14]]}", narrowing = "{G: 0.6, 2HG: 2, 2HG5: 0.8}";
  const std::string open = "{loading: [[0, 0], [0.3, 20]], unloading: [[0, -3], [0.3, 16]]}";
  for (const auto& [warp, weft] : {std::pair(closing, elastic),
                                   {elastic, closing},
                                   {closing, open},
                                   {narrowing, elastic},
                                   {narrowing, open},
                                   {closing, narrowing}}) {
    SCOPED_TRACE(warp + ", " + weft);
    const Fabric fabric =
        load(std::string(kHead) + kTensile + "shear: {warp: " + warp + ", weft: " + weft + "}\n");
    for (int k = -400; k <= 400; ++k) {
      const double s = 0.001 * k, upper = fabric.shear.upper()(s).force,
                   lower = fabric.shear.lower()(s).force;
      ASSERT_GE(upper - lower, -1e-12) << s;
      ASSERT_GE(fabric.shear.lower()(s).slope, -1e-9) << s;
    }
  }
}

TEST_F(FabricFile, MissingGroupsAreNoLaw) {
  const Fabric fabric = load(std::string(kHead) + kTensile);
  EXPECT_TRUE(fabric.bending[kWarp].isZero());
  EXPECT_TRUE(fabric.bending[kWeft].isZero());
  EXPECT_TRUE(fabric.shear.isZero());
}

TEST_F(FabricFile, WrongDocumentsAndValuesAreNamed) {
  const std::string base = std::string(kHead) + kTensile;
  EXPECT_NE(message(base + "bending: {B: 1\n").find("malformed YAML"), std::string::npos);
  for (const auto& [text, hint] :
       {std::pair("bending:\n\tB: 1\n", "cloth.yaml:6: malformed YAML: "),
        std::pair("bending:\n\tB: 1\n", " (the line has a tab: indent with spaces)"),
        std::pair("bending:x\nshear: {G: 1}\n", "lacks a space behind the colon)")}) {
    EXPECT_NE(message(base + text).find(hint), std::string::npos) << message(base + text);
  }
  expectMessages({
      {"", "cloth.yaml: is empty, must be a YAML mapping"},
      {"- 1\n", "cloth.yaml: [1]: must be a YAML mapping"},
      {base + "---\na: 1\n", "cloth.yaml: must hold one YAML document, not several"},
      {base + "densty: 3\n",
       "cloth.yaml:5: densty: unknown key; known here: name, source, assumed, areal_density, thickness, "
       "tensile, bending, shear, compression, compression_ratio"},
      {base + "thickness: 0.1\n", "cloth.yaml:5: thickness: must not stand here twice"},
      {"areal_density: 0.2\nthickness: 0.1\ntensile: {stiffness: 1}\n",
       "cloth.yaml:1: source: is required: where the numbers come from"},
      {"source: x\nthickness: 0.1\n", "cloth.yaml:1: areal_density: is required"},
      {"source: x\nareal_density: 0\n", "cloth.yaml:2: areal_density = 0: must be > 0"},
      {"source: x\nareal_density: true\n", "cloth.yaml:2: areal_density = true: must be a finite number"},
      {"source: x\nareal_density: .nan\n", "cloth.yaml:2: areal_density = .nan: must be a finite number"},
      {"source: x\nareal_density: 1e999\n", "cloth.yaml:2: areal_density = 1e999: must be a finite number"},
      {"source: x\nareal_density: \"0.2\"\n",
       "cloth.yaml:2: areal_density = \"0.2\": must be a finite number"},
      {"source: x\nareal_density: 0.2\nthickness: -1\n", "cloth.yaml:3: thickness = -1: must be > 0"},
      {kHead, "cloth.yaml:1: tensile: is required"},
      {"source: x\nareal_density: 1e-13\n", "cloth.yaml:2: areal_density = 1e-13: must be at least 1e-12"},
      {"source: x\nareal_density: 1e13\n",
       "cloth.yaml:2: areal_density = 1e13: must be within -1e12 to 1e12"},
      // Values as in data sheets: g/m², mm, and fractions for percentages. Fabrics have 0.01 to 5
      // kg/m², up to 10 mm, EMT from 0.5 % and RT from 30 %.
      {"source: x\nareal_density: 350\n",
       "cloth.yaml:2: areal_density = 350: must be at most 10: it is in kg/m^2, not g/m^2"},
      {"source: x\nareal_density: 0.35\nthickness: 0.8\n",
       "cloth.yaml:3: thickness = 0.8: must be at most 0.05: it is in m, not mm"},
      {base + "bending: {B: 1e13}\n", "cloth.yaml:5: bending.B = 1e13: must be within -1e12 to 1e12"},
      {base + "shear: {loading: [[0, 0], [1.0e-13, 1]]}\n",
       "cloth.yaml:5: shear.loading[1] = [1.0e-13, 1]: must end at 1e-12 at least"},
      {base + "compression_ratio: -0.1\n", "cloth.yaml:5: compression_ratio = -0.1: must be >= 0"},
      {base + "assumed: shear\n", "cloth.yaml:5: assumed = shear: must be a list"},
      {base + "assumed: [sheer]\n",
       "cloth.yaml:5: assumed[0] = sheer: must be one of areal_density, thickness, tensile, bending, shear, "
       "compression, compression_ratio"},
  });
}

TEST_F(FabricFile, WrongBendingLawsAreNamed) {
  const std::string base = std::string(kHead) + kTensile;
  expectMessages({
      {base + "bending: {B: -1}\n", "cloth.yaml:5: bending.B = -1: must be >= 0"},
      {base + "bending: {B: 1, 2HB: -1}\n", "cloth.yaml:5: bending.2HB = -1: must be >= 0"},
      {base + "bending: {B: 1, bias: {B: -1}}\n", "cloth.yaml:5: bending.bias.B = -1: must be >= 0"},
      {base + "bending: {B: 1, bias: {C: 1}}\n", "cloth.yaml:5: bending.bias.C: unknown key; known here: B"},
      {base + "bending: {B: 1, bias: {B: 0,04}}\n",
       "cloth.yaml:5: bending.bias.04: unknown key; decimals follow a point; known here: B"},
      {base + "bending: {warp: {B: 1}}\n", "cloth.yaml:5: bending.weft: is required beside warp"},
      {base + "bending: {warp: {B: 1}, weft: {B: 1}, 2HB: 1}\n",
       "cloth.yaml:5: bending.2HB = 1: must not stand beside warp and weft"},
      {base + "bending: 1\n",
       "cloth.yaml:5: bending = 1: must be a mapping with keys out of: B, 2HB, rigidity, loading, "
       "unloading, bias, warp, weft"},
  });
}

TEST_F(FabricFile, WrongShearLawsAreNamed) {
  const std::string base = std::string(kHead) + kTensile;
  expectMessages({
      {base + "shear: {G: 1, modulus: 1}\n",
       "cloth.yaml:5: shear = {G: 1, modulus: 1}: must have exactly one of: KES parameters (G, 2HG, 2HG5), "
       "modulus, or tables (loading, unloading)"},
      {base + "shear: {}\n",
       "cloth.yaml:5: shear = {}: must have exactly one of: KES parameters (G, 2HG, 2HG5), modulus, or "
       "tables (loading, unloading)"},
      {base + "shear: {G: 1, 2HG: 2, 2HG5: 0.7}\n",
       "cloth.yaml:5: shear.2HG5 = 0.7: must differ from 2HG by at most 9 G and be 0.4 to 10 times 2HG"},
      {base + "shear: {2HG: 1}\n", "cloth.yaml:5: shear.G: is required"},
      {base + "shear: {modulus: -2}\n", "cloth.yaml:5: shear.modulus = -2: must be >= 0"},
      {base + "shear: {G: 1, bias: {B: 1}}\n",
       "cloth.yaml:5: shear.bias: unknown key; known here: G, 2HG, 2HG5, modulus, loading, unloading, warp, "
       "weft"},
      {base + "shear: {loading: [[0, 0]]}\n",
       "cloth.yaml:5: shear.loading = [[0, 0]]: must have at least two rows"},
      {base + "shear: {loading: [[0, 0], [0, 1]]}\n",
       "cloth.yaml:5: shear.loading[1] = [0, 1]: the first column must increase strictly from row to row"},
      {base + "shear: {loading: [[0, 0], [0.1, 1], [0.2, 0.5]]}\n",
       "cloth.yaml:5: shear.loading[2] = [0.2, 0.5]: the second column (the force) must not decrease from "
       "row to row"},
      {base + "shear: {loading: [[0, 1], [0.1, 2]]}\n",
       "cloth.yaml:5: shear.loading[0] = [0, 1]: the first row must be [0, 0]"},
      {base + "shear: {loading: [[0, 0], [0.1]]}\n",
       "cloth.yaml:5: shear.loading[1] = [0.1]: must be a list of 2 numbers"},
      {base + "shear: {unloading: [[0, 0], [0.1, 1]]}\n",
       "cloth.yaml:5: shear.loading: is required beside unloading"},
      {base + "shear: {loading: [[0, 0], [0.1, 2]], unloading: [[0, 0], [0.05, 1.5]]}\n",
       "cloth.yaml:5: shear.unloading[1] = [0.05, 1.5]: unloading must not lie above loading"},
      {base + "shear: {loading: [[0, 0], [0.1, 1], [0.2, 20]], unloading: [[0, 0], [0.2, 20]]}\n",
       "cloth.yaml:5: shear.unloading = [[0, 0], [0.2, 20]]: unloading must not lie above loading, as it "
       "does "
       "at 0.1"},
      {base + "shear: {loading: [[0, 0], [0.1, 2]], unloading: [[0, 0], [0.2, 2]]}\n",
       "cloth.yaml:5: shear.unloading[1] = [0.2, 2]: the first column must stay within that of loading"},
  });
}

TEST_F(FabricFile, WrongTensileLawsAreNamed) {
  expectMessages({
      {std::string(kHead) + "tensile: {EMT: 0, LT: 0.6}\n", "cloth.yaml:4: tensile.EMT = 0: must be > 0"},
      {std::string(kHead) + "tensile: {EMT: 0.055, LT: 0.6}\n",
       "cloth.yaml:4: tensile.EMT = 0.055: must be at least 0.1: it is in %"},
      {std::string(kHead) + "tensile: {EMT: 5, LT: 0.6, RT: 0.54}\n",
       "cloth.yaml:4: tensile.RT = 0.54: must be > 1 and <= 100: it is in %"},
      {std::string(kHead) + "tensile: {EMT: 5}\n", "cloth.yaml:4: tensile.LT: is required"},
      {std::string(kHead) + "tensile: {EMT: 5, LT: 1.2}\n",
       "cloth.yaml:4: tensile.LT = 1.2: must be within 0.05 to 1"},
      {std::string(kHead) + "tensile: {EMT: 5, LT: 0.04}\n",
       "cloth.yaml:4: tensile.LT = 0.04: must be within 0.05 to 1"},
      {std::string(kHead) + "tensile: {EMT: 5, LT: 0.5, RT: 7.9}\n",
       "cloth.yaml:4: tensile.RT = 7.9: must be at least 8 (4/LT): the samples of the law resolve no steeper "
       "unloading"},
      {std::string(kHead) + "tensile: {EMT: 5, LT: 0.6, RT: 0}\n",
       "cloth.yaml:4: tensile.RT = 0: must be > 1 and <= 100: it is in %"},
      {std::string(kHead) + "tensile: {EMT: 5, LT: 0.6, RT: 101}\n",
       "cloth.yaml:4: tensile.RT = 101: must be > 1 and <= 100: it is in %"},
      {std::string(kHead) + "tensile: {stiffness: 0}\n", "cloth.yaml:4: tensile.stiffness = 0: must be > 0"},
      {std::string(kHead) + "tensile: {loading: [[0, 0], [0.1, 0]]}\n",
       "cloth.yaml:4: tensile.loading = [[0, 0], [0.1, 0]]: the last force must be > 0"},
  });
}

TEST_F(FabricFile, UnreadableFilesAreNamed) {
  for (const std::string& file : {directory_.string(), (directory_ / "missing.yaml").string()}) {
    try {
      loadFabric(file);
      FAIL() << file;
    } catch (const InputError& error) {
      EXPECT_EQ(std::string(error.what()).find(file), 0U) << error.what();
    }
  }
}

TEST_F(FabricFile, IsFoundByPathThenInTheSearchPathThenBesideTheScenes) {
  fs::create_directories(directory_ / "scenes");
  fs::create_directories(directory_ / "fabrics");
  fs::create_directories(directory_ / "mine");
  const std::string base = (directory_ / "scenes").string();
  const std::string beside = write("", "fabrics/a.yaml");
  EXPECT_EQ(findFabric("a", base), beside);
  EXPECT_EQ(findFabric("../fabrics/a.yaml", base), beside);
  EXPECT_EQ(findFabric(beside, base), beside);
  EXPECT_EQ(findFabric("b", base), "");
  EXPECT_EQ(findFabric("a.yaml", base), "");

  const std::string mine = write("", "mine/a.yaml");
  setenv("HAPTIC_CLOTH_FABRIC_PATH", ("/nowhere::" + (directory_ / "mine").string()).c_str(), 1);
  EXPECT_EQ(findFabric("a", base), mine);
  unsetenv("HAPTIC_CLOTH_FABRIC_PATH");
}

TEST_F(FabricFile, EachPlaceIsSearchedOnce) {
  const std::string base = (directory_ / "scenes").string();
  setenv("HAPTIC_CLOTH_FABRIC_PATH", (base + "/../fabrics:" + base + "/.").c_str(), 1);
  std::vector<std::string> places = fabricCandidates("a", base);
  unsetenv("HAPTIC_CLOTH_FABRIC_PATH");
  EXPECT_EQ(places.at(0), (directory_ / "fabrics/a.yaml").string());
  EXPECT_EQ(places.at(1), (directory_ / "scenes/a.yaml").string());
  std::sort(places.begin(), places.end());
  EXPECT_EQ(std::unique(places.begin(), places.end()), places.end());
}

TEST(ShippedFabrics, AllLoad) {
  int count = 0;
  for (const auto& entry : fs::directory_iterator(HAPTIC_CLOTH_SOURCE_DIR "/config/fabrics")) {
    SCOPED_TRACE(entry.path().string());
    const Fabric fabric = loadFabric(entry.path().string());
    EXPECT_EQ(fabric.name, entry.path().stem().string());
    EXPECT_EQ(findFabric(fabric.name, "/nowhere/at/all"), entry.path().lexically_normal().string());
    EXPECT_FALSE(fabric.tensile[kWarp].isZero());
    EXPECT_FALSE(fabric.bending[kWeft].isZero());
    EXPECT_FALSE(fabric.shear.isZero());
    ++count;
  }
  EXPECT_GE(count, 4);
}

}  // namespace
}  // namespace haptic_cloth::fabric_test
