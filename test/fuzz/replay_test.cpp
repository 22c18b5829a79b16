/// Runs the readers of scene files, fabric files, --set and recordings on unusual inputs: the kept
/// seeds, a fixed set of mutations of them, and inputs that are far too large. Criteria as in the
/// libFuzzer programs (scripts/fuzz.sh; not of recordings): those of readers.h; no crash, and no exception
/// but InputError with source and rule. All of it uses less than kMost memory above that at the start: an
/// input that stands for 1e9 values is refused before it is built.
#include <gtest/gtest.h>
#include <sys/resource.h>

#include <cstdlib>
#include <fstream>

#include "fuzz/mutation.h"
#include "fuzz/readers.h"
#include "fuzz/recording_reader.h"
#include "haptic_cloth/error.h"
#include "haptic_cloth/fabric.h"
#include "haptic_cloth/scene.h"

namespace haptic_cloth::replay_test {
namespace {

struct Reader {
  const char* name;
  bool (*read)(const std::string&);
  std::vector<std::string> seeds;
};

void PrintTo(const Reader& reader, std::ostream* stream) { *stream << reader.name; }

const Reader kReaders[] = {{"scene", readSceneBytes, {"test/fuzz/seeds/scene", "config/scenes"}},
                           {"fabric", readFabricBytes, {"test/fuzz/seeds/fabric", "config/fabrics"}},
                           {"override", readOverrideBytes, {"test/fuzz/seeds/override"}},
                           {"recording", readRecordingBytes, {"test/fuzz/seeds/recording"}}};

/// Runs one input. A broken promise fails the test and keeps the input in a file. @return 1 if the
/// input was accepted
int hold(const Reader& reader, const std::string& bytes, const std::string& label) {
  try {
    return reader.read(bytes) ? 1 : 0;
  } catch (const std::exception& error) {
    const std::string file = testing::TempDir() + "broken_" + reader.name + "_" + label;
    std::ofstream(file, std::ios::binary) << bytes;
    ADD_FAILURE() << reader.name << ", " << label << ": " << error.what() << "\n  input kept in " << file;
    return 0;
  }
}

class Readers : public testing::TestWithParam<Reader> {};

TEST_P(Readers, HoldOnEverySeed) {
  const std::vector<Seed> seeds = readSeeds(GetParam().seeds);
  EXPECT_GT(seeds.size(), 4U);
  int accepted = 0;
  for (const Seed& seed : seeds) {
    SCOPED_TRACE(seed.file);
    accepted += hold(GetParam(), seed.bytes, "seed");
  }
  // Seeds exist for acceptance and for refusal.
  EXPECT_GT(accepted, 2);
  EXPECT_LT(accepted, static_cast<int>(seeds.size()));
}

TEST_P(Readers, HoldOnMutations) {
  constexpr int kMutations = 1500;
  const std::vector<Seed> seeds = readSeeds(GetParam().seeds);
  Dice dice(20040607);
  int accepted = 0;
  for (int k = 0; k < kMutations; ++k) {
    const std::string bytes = mutated(dice.choice(seeds).bytes, seeds, dice);
    accepted += hold(GetParam(), bytes, std::to_string(k));
  }
  // The mutations are neither all broken at the first byte nor all harmless.
  EXPECT_GT(accepted, kMutations / 50);
  EXPECT_LT(accepted, kMutations * 9 / 10);
}

INSTANTIATE_TEST_SUITE_P(All, Readers, testing::ValuesIn(kReaders),
                         [](const auto& info) { return std::string(info.param.name); });

// ---- inputs far too large, because libFuzzer uses only a few KB ----

std::string repeated(const std::string& text, int count) {
  std::string all;
  for (int k = 0; k < count; ++k) all += text;
  return all;
}

std::string refusal(const std::string& yaml) {
  try {
    parseScene(yaml, "scene", ".");
  } catch (const InputError& error) {
    return error.what();
  }
  return "accepted";
}

std::string fabricRefusal(const std::string& yaml) {
  try {
    parseFabric(yaml, "cloth.yaml", "cloth");
  } catch (const InputError& error) {
    return error.what();
  }
  return "accepted";
}

constexpr char kCloth[] = "cloth: {fabric: linear}\n";
constexpr char kTooMany[] = "scene: must hold at most 1048576 values";
constexpr char kAlias[] = "scene: must not hold an alias (*name); write the value again";

/// Peak memory of this process so far [MiB].
long peakMemory() {
  rusage usage{};
  getrusage(RUSAGE_SELF, &usage);
  return usage.ru_maxrss / 1024;
}

/// The largest allowed input takes about 500 MiB (1 million values of about 500 bytes in yaml-cpp).
/// Each input here would take more than 10 GiB.
class TooLarge : public testing::Test {
 protected:
  static constexpr long kMost = 1024;  // [MiB]
  void TearDown() override { EXPECT_LT(peakMemory() - before_, kMost); }
  long before_ = peakMemory();
};

TEST_F(TooLarge, GridsAreRefused) {
  EXPECT_EQ(refusal("cloth: {fabric: linear, particles: [32769, 32769]}"),
            "scene: cloth.particles = 1.07381e+09: the product must be at most 2^24");
  EXPECT_EQ(refusal("cloth: {fabric: linear, particles: [2147483645, 2147483645], pins: [edge_x1]}"),
            "scene: cloth.particles = 4.61169e+18: the product must be at most 2^24");
}

TEST_F(TooLarge, AliasesAreRefused) {
  // Ten levels with ten aliases each would be 10^10 rows from 300 bytes.
  std::string yaml = "a0: &a0 [0, 0, 0, 0]\n";
  for (int k = 1; k <= 10; ++k) {
    const std::string alias = "*a" + std::to_string(k - 1) + ", ";
    yaml += "a" + std::to_string(k) + ": &a" + std::to_string(k) + " [" + repeated(alias, 10) + "]\n";
  }
  EXPECT_EQ(refusal(yaml + kCloth), kAlias);
  EXPECT_EQ(refusal("cloth: &c {fabric: linear, pins: [*c]}"), kAlias);
}

TEST_F(TooLarge, DocumentsWithoutEndAreRefused) {
  // yaml-cpp 0.7 returns an endless series of empty documents.
  EXPECT_EQ(refusal(", s{ti}"), "scene: must hold one YAML document, not several");
}

TEST_F(TooLarge, DeepNestsAreRefused) {
  const std::string rule = "scene: must not nest lists and mappings deeper than 32";
  for (const char* word : {"[", "{a: ", "- ", "? ", "{[", "[{", "{? "}) {
    EXPECT_EQ(refusal(repeated(word, 100000)), rule) << word;
  }
  std::string steps;  // a block that is indented by one more column in each line
  for (int k = 0; k < 2000; ++k) steps += repeated(" ", k) + "a:\n";
  EXPECT_EQ(refusal(steps), rule);
}

TEST_F(TooLarge, LongTextsAreRefused) {
  EXPECT_EQ(refusal(repeated("# comment\n", 2000000)), "scene: must be at most 16777216 bytes long");
  EXPECT_EQ(refusal(std::string(kCloth) + "obstacles: [" + repeated("1,", 1100000) + "]"), kTooMany);
  EXPECT_EQ(refusal("cloth: {fabric: " + repeated("x", 3000000) + "}").substr(0, 30),
            "scene: cloth.fabric = xxxxxxxx");
  EXPECT_EQ(refusal("? " + repeated("x", 3000000) + "\n: 1\n").substr(0, 20), "scene: xxxxxxxxxxxxx");
}

TEST_F(TooLarge, AFileWithoutAnEndIsRefused) {
  try {
    loadScene("/dev/zero");
    ADD_FAILURE() << "accepted";
  } catch (const InputError& error) {
    EXPECT_STREQ(error.what(), "/dev/zero: must be at most 16777216 bytes long");
  }
}

TEST_F(TooLarge, ManyProbesObstaclesAndPinsAreRefused) {
  std::string probes = std::string(kCloth) + "probes: {";
  for (int k = 0; k < 50000; ++k) probes += "p" + std::to_string(k) + ": {},";
  EXPECT_EQ(refusal(probes + "}"), "scene: probes = 50000 entries: must have at most 64");
  EXPECT_EQ(refusal(std::string(kCloth) + "obstacles: [" + repeated("{shape: plane},", 1025) + "]"),
            "scene: obstacles = 1025 entries: must have at most 1024");
  EXPECT_EQ(
      refusal("cloth: {fabric: linear, particles: [4093, 4093]}\nobstacles: [" +
              repeated("{shape: plane},", 4) + "]"),
      "scene: cloth.particles = 8.37632e+07: the product, times the number of obstacles and probes, must be "
      "at most 2^26");
  EXPECT_EQ(refusal("cloth: {fabric: linear, pins: [" + repeated("edge_x0,", 4097) + "]}"),
            "scene: cloth.pins = 4097 entries: must have at most 4096");
}

TEST_F(TooLarge, LongTablesAreReadInOneGo) {
  // The time grows linearly with the number of rows. Quadratic growth would take minutes.
  std::string rows;
  for (int k = 0; k < 100000; ++k) rows += "[" + std::to_string(k) + "," + std::to_string(k) + "],";
  const std::string head = "source: x\nareal_density: 0.1\nthickness: 0.001\n";
  EXPECT_EQ(fabricRefusal(head + "tensile: {loading: [" + rows + "]}"), "accepted");
}

}  // namespace
}  // namespace haptic_cloth::replay_test
