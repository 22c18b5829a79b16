/// Command-line program `simulate`, run as by a user: exit status, messages, files.
#include <gtest/gtest.h>
#include <sys/stat.h>
#include <sys/wait.h>
#include <unistd.h>

#include <algorithm>
#include <cmath>
#include <cstdlib>
#include <filesystem>
#include <fstream>
#include <iostream>
#include <nlohmann/json.hpp>
#include <sstream>
#include <string>
#include <vector>

#include "haptic_cloth/machine.h"
#include "haptic_cloth/scene.h"
#include "haptic_cloth/simulation.h"
#include "sim/recording.h"
#include "simd/path.h"
#include "support/state_cases.h"

namespace haptic_cloth::simulate_test {
namespace {

namespace fs = std::filesystem;

constexpr const char* kFabric =
    "name: linen\nsource: made up for a test\nareal_density: 0.15\nthickness: 0.0005\n"
    "tensile: {warp: {stiffness: 1000}, weft: {stiffness: 1000}}\n"
    "bending: {warp: {rigidity: 1.0e-5}, weft: {rigidity: 1.0e-5}}\n"
    "shear: {modulus: 30}\n";

constexpr const char* kScene =
    "cloth: {particles: [9, 5], size: [0.08, 0.04], position: [0, 0, 0.05], fabric: linen.yaml,\n"
    "        pins: [edge_x0]}\n"
    "probe: {radius: 0.01, path: [[0, 0.02, 0, 0.08], [0.02, 0.02, 0, 0.055]]}\n"
    "adapt: {strategy: amrc, levels: 2}\n"
    "stop: {time: 0.03}\n";

struct Outcome {
  int status;
  std::string output, error;
};

std::string readText(const fs::path& file) {
  std::ifstream stream(file);
  std::ostringstream text;
  text << stream.rdbuf();
  return text.str();
}

std::vector<std::string> readLines(const fs::path& file) {
  std::ifstream stream(file);
  std::vector<std::string> lines;
  for (std::string line; std::getline(stream, line);) lines.push_back(line);
  return lines;
}

std::vector<std::string> split(const std::string& line, char separator) {
  std::vector<std::string> fields;
  std::istringstream stream(line);
  for (std::string field; std::getline(stream, field, separator);) fields.push_back(field);
  return fields;
}

class Simulate : public testing::Test {
 protected:
  void SetUp() override {
    folder_ = fs::temp_directory_path() /
              ("haptic_cloth_" + std::string(testing::UnitTest::GetInstance()->current_test_info()->name()) +
               "_" + std::to_string(getpid()));
    fs::create_directories(folder_);
    write("linen.yaml", kFabric);
    write("scene.yaml", kScene);
  }
  void TearDown() override { fs::remove_all(folder_); }

  void write(const std::string& file, const std::string& text) const {
    std::ofstream(folder_ / file) << text;
  }

  /// Runs the program in the test's folder. @param before shell commands in front of it, for
  /// instance limits
  Outcome run(const std::string& arguments, const std::string& before = "") const {
    return runProgram("'" HAPTIC_CLOTH_SIMULATE "' " + arguments + " >output.txt", before);
  }

  /// Runs any command in the test's folder.
  Outcome runProgram(const std::string& words, const std::string& before = "") const {
    write("output.txt", "");
    const std::string command = "cd '" + folder_.string() + "' && " + before + " " + words + " 2>error.txt";
    const int status = std::system(command.c_str());
    return {WEXITSTATUS(status), readText(folder_ / "output.txt"), readText(folder_ / "error.txt")};
  }

  /// Names in a subfolder of the test's folder.
  std::vector<std::string> files(const std::string& folder) const {
    std::vector<std::string> names;
    for (const auto& entry : fs::directory_iterator(folder_ / folder))
      names.push_back(entry.path().filename().string());
    std::sort(names.begin(), names.end());
    return names;
  }

  /// Expects bad input to be refused: status 2, one line that contains every word, no result
  /// folder.
  void expectRefused(const std::string& arguments, const std::vector<std::string>& words,
                     const std::string& before = "") const {
    SCOPED_TRACE(before + " " + arguments);
    const Outcome outcome = run(arguments + " --out result", before);
    EXPECT_EQ(outcome.status, 2);
    EXPECT_EQ(std::count(outcome.error.begin(), outcome.error.end(), '\n'), 1) << outcome.error;
    EXPECT_EQ(outcome.output, "");
    for (const std::string& word : words) {
      EXPECT_NE(outcome.error.find(word), std::string::npos) << "no '" << word << "' in: " << outcome.error;
    }
    EXPECT_FALSE(fs::exists(folder_ / "result"));
  }

  fs::path folder_;
};

TEST_F(Simulate, WritesEveryFile) {
  const Outcome outcome = run("scene.yaml --out result/of/run");
  ASSERT_EQ(outcome.status, 0) << outcome.error;
  EXPECT_EQ(outcome.error, "") << "progress belongs on a terminal only";
  EXPECT_EQ(files("result/of/run"), (std::vector<std::string>{"mesh.ply", "particles.csv", "probe.csv",
                                                              "steps.csv", "summary.json"}));
}

TEST_F(Simulate, SaysHowFarAnObstacleLags) {
  // A ball of 20 mm is sent 0.1 m in ten steps. In each it makes a quarter of its radius, 5 mm.
  const std::string ball =
      "scene.yaml --set solver.time_step=0.001 --set stop.time=0.01 --set 'obstacles=[{shape: sphere, "
      "radius: 0.02, position: [0, 0, -1], path: [[0, 0, 0, -1], [0.01, 0.1, 0, -1]]}]'";
  const Outcome outcome = run(ball);
  EXPECT_NE(outcome.output.find("an obstacle lagged behind its path by up to 50 mm"), std::string::npos)
      << outcome.output;
  ASSERT_EQ(run(ball + " --out result").status, 0);
  const auto summary = nlohmann::json::parse(readText(folder_ / "result/summary.json"));
  EXPECT_NEAR(summary["max_obstacle_lag"], 0.05, 1e-9);
  EXPECT_EQ(run("scene.yaml").output.find("lagged"), std::string::npos);
}

TEST_F(Simulate, SummaryHasItsKeys) {
  ASSERT_EQ(run("scene.yaml --out result").status, 0);
  const auto summary = nlohmann::json::parse(readText(folder_ / "result/summary.json"));
  for (const char* key :
       {"simulated_time", "wall_time", "real_time_factor", "steps", "iterations", "threads",
        "active_particles", "processor", "simd", "cost", "energy", "max_strain", "max_speed",
        "max_penetration", "probe_force", "support_force", "failed_steps", "mass", "state_hash"}) {
    EXPECT_TRUE(summary.contains(key)) << key;
  }
  EXPECT_EQ(summary["crossings"], 0);
  for (const char* key : {"min", "mean", "max", "final"})
    EXPECT_TRUE(summary["active_particles"].contains(key));
  for (const char* key : {"total", "motion", "stretch", "bend", "shear"}) {
    EXPECT_TRUE(summary["cost"].contains(key)) << key;
  }
  for (const char* key : {"kinetic", "gravity", "stretch", "bend", "shear", "contact", "dissipated"}) {
    EXPECT_TRUE(summary["energy"].contains(key)) << key;
  }
  EXPECT_EQ(summary["steps"], 30);
  EXPECT_EQ(summary["failed_steps"], 0);
  EXPECT_NEAR(summary["simulated_time"].get<double>(), 0.03, 1e-12);
  EXPECT_NEAR(summary["mass"].get<double>(), 0.15 * 0.08 * 0.04, 1e-15);
  EXPECT_EQ(summary["probe_force"].size(), 3u);
  EXPECT_EQ(summary["processor"], processorName());
  EXPECT_EQ(summary["simd"], instructionSet());
  EXPECT_EQ(summary["probe_force_of"], "probe");
}

TEST_F(Simulate, SummaryCountsTheStepsThatConverged) {
  ASSERT_EQ(run("scene.yaml --set solver.max_iterations=2 --out result").status, 0);
  const auto summary = nlohmann::json::parse(readText(folder_ / "result/summary.json"));
  const auto lines = readLines(folder_ / "result/steps.csv");
  const auto names = split(lines.front(), ',');
  const auto column = [&](const char* name) {
    return static_cast<std::size_t>(std::find(names.begin(), names.end(), name) - names.begin());
  };
  int converged = 0;
  double largest = 0.0;
  for (std::size_t row = 1; row < lines.size(); ++row) {
    const auto cells = split(lines[row], ',');
    if (cells[column("termination")] == "converged") ++converged;
    largest = std::max(largest, std::stod(cells[column("residual")]));
  }
  EXPECT_EQ(summary["converged_steps"], converged);
  EXPECT_LT(converged, 30);
  EXPECT_EQ(summary["max_residual"].get<double>(), largest);
}

TEST_F(Simulate, ForcesAreThoseOfNamedProbes) {
  // Both probes are present, but only the second touches the cloth.
  const std::string probes =
      "--set 'probes={thumb: {path: [[0, 0, 0, 0.5]]}, index: {path: [[0, 0, 0, 0.08], [0.02, 0, 0, "
      "0.04]]}}'";
  ASSERT_EQ(run("scene.yaml " + probes + " --out result").status, 0);
  const auto summary = nlohmann::json::parse(readText(folder_ / "result/summary.json"));
  EXPECT_EQ(summary["probe_force_of"], "thumb");
  EXPECT_EQ(summary["probe_force"], summary["probe_forces"]["thumb"]);
  EXPECT_NE(summary["probe_forces"]["index"], summary["probe_forces"]["thumb"]);
  const Outcome report = run("scene.yaml " + probes);
  ASSERT_EQ(report.status, 0) << report.error;
  for (const char* words : {"force on thumb 0 0 0 N", "force on index "})
    EXPECT_NE(report.output.find(words), std::string::npos) << report.output;
}

TEST_F(Simulate, TablesHaveARowForEach) {
  ASSERT_EQ(run("scene.yaml --out result").status, 0);
  const struct {
    const char* file;
    std::size_t rows, columns;
  } tables[] = {{"steps.csv", 30, 23}, {"probe.csv", 30, 14}, {"particles.csv", 45, 6}};
  for (const auto& table : tables) {
    SCOPED_TRACE(table.file);
    const auto lines = readLines(folder_ / "result" / table.file);
    ASSERT_EQ(lines.size(), table.rows + 1);
    for (const std::string& line : lines) EXPECT_EQ(split(line, ',').size(), table.columns);
  }
  // The device is at the end of the path, lowered; the first particle is pinned at its start.
  const auto probe = split(readLines(folder_ / "result/probe.csv").back(), ',');
  EXPECT_NEAR(std::stod(probe[0]), 0.03, 1e-12);
  EXPECT_NEAR(std::stod(probe[3]), 0.055, 1e-12);
  const auto particles = readLines(folder_ / "result/particles.csv");
  EXPECT_EQ(particles[0], "i,j,active,x,y,z");
  const auto corner = split(particles[1], ',');
  EXPECT_EQ(corner[0] + corner[1] + corner[2], "001");
  EXPECT_DOUBLE_EQ(std::stod(corner[3]), -0.04);
  EXPECT_DOUBLE_EQ(std::stod(corner[5]), 0.05);
}

TEST_F(Simulate, MeshIsConsistent) {
  ASSERT_EQ(run("scene.yaml --out result").status, 0);
  const auto lines = readLines(folder_ / "result/mesh.ply");
  ASSERT_GT(lines.size(), 9u);
  EXPECT_EQ(lines[0], "ply");
  const std::size_t vertices = std::stoul(split(lines[2], ' ').back());
  const std::size_t faces = std::stoul(split(lines[6], ' ').back());
  EXPECT_EQ(lines[8], "end_header");
  ASSERT_EQ(lines.size(), 9 + vertices + faces);
  for (std::size_t k = 9 + vertices; k < lines.size(); ++k) {
    const auto face = split(lines[k], ' ');
    ASSERT_EQ(face.size(), 4u);
    for (int c = 1; c < 4; ++c) EXPECT_LT(std::stoul(face[c]), vertices);
  }
}

/// Cells are cut along one diagonal and the other in turn, as their contact is (Cell::diagonalRises()).
TEST_F(Simulate, MeshHasTheTrianglesThatTouch) {
  ASSERT_EQ(run("scene.yaml --set adapt.strategy=finest --out result").status, 0);
  const auto lines = readLines(folder_ / "result/mesh.ply");
  const std::size_t first = 9 + std::stoul(split(lines[2], ' ').back());
  std::size_t rising = 0;
  for (std::size_t k = first; k < lines.size(); k += 2) {
    const auto one = split(lines[k], ' '), other = split(lines[k + 1], ' ');
    rising += one[1] == other[1] && one[3] == other[2] ? 1 : 0;
  }
  EXPECT_EQ(rising, (lines.size() - first) / 4);
}

TEST_F(Simulate, SetReplacesKeys) {
  const Outcome outcome = run(
      "scene.yaml --set stop.time=0.01 --set adapt.strategy=finest --set 'gravity=[0, 0, 0]' --out result");
  ASSERT_EQ(outcome.status, 0) << outcome.error;
  const auto summary = nlohmann::json::parse(readText(folder_ / "result/summary.json"));
  EXPECT_EQ(summary["steps"], 10);
  EXPECT_EQ(summary["active_particles"]["final"], 45);
}

TEST_F(Simulate, SameInputGivesSameHash) {
  ASSERT_EQ(run("scene.yaml --out one").status, 0);
  const auto one = nlohmann::json::parse(readText(folder_ / "one/summary.json"));
  for (const char* threads : {"2", "3"}) {
    ASSERT_EQ(run("scene.yaml --set solver.threads=" + std::string(threads) + " --out more").status, 0);
    const auto more = nlohmann::json::parse(readText(folder_ / "more/summary.json"));
    EXPECT_EQ(one["state_hash"], more["state_hash"]) << threads << " threads";
    EXPECT_EQ(readText(folder_ / "one/particles.csv"), readText(folder_ / "more/particles.csv"));
  }
}

// Bound of the test below. Every step ends with a residual of at most τ (tolerance) times the
// weight, root mean square. In a time T such a residual moves the cloth by τ g T² / 2, root mean
// square by mass. By number this may be twice as much, since particles at the corners have a
// quarter of the others' mass. Two runs: twice that.
TEST_F(Simulate, PathsAgreeWithinTheTolerance) {
  constexpr double kTolerance = 1e-4, kTime = 0.03, kGravity = 9.81;
  const double bound = 2.0 * 2.0 * 0.5 * kTolerance * kGravity * kTime * kTime;
  for (const std::string fabric : {"linen.yaml", "winter_suiting"}) {
    std::string first;
    std::vector<double> expected;
    for (const SimdPath& path : simdPaths()) {
      if (!path.available) continue;
      const Outcome outcome =
          run("scene.yaml --set adapt.strategy=finest --set solver.tolerance=1e-4 "
              "--set solver.max_iterations=5000 --set cloth.fabric=" +
                  fabric + " --out " + path.name,
              "HAPTIC_CLOTH_SIMD=" + path.name);
      ASSERT_EQ(outcome.status, 0) << outcome.error;
      const auto summary = nlohmann::json::parse(readText(folder_ / path.name / "summary.json"));
      EXPECT_EQ(summary["simd"], path.name);
      EXPECT_NEAR(summary["simulated_time"].get<double>(), kTime, 1e-12);
      std::vector<double> found;
      for (const std::string& line : readLines(folder_ / path.name / "particles.csv")) {
        const auto cells = split(line, ',');
        for (std::size_t c = 3; c < 6 && cells[0] != "i"; ++c) found.push_back(std::stod(cells[c]));
      }
      ASSERT_EQ(found.size(), 3u * 45);
      if (first.empty()) {
        first = path.name;
        expected = found;
      }
      double squares = 0.0;
      for (std::size_t k = 0; k < found.size(); ++k) squares += std::pow(found[k] - expected[k], 2);
      const double apart = std::sqrt(squares / 45);
      std::cout << "  " << fabric << ", " << path.name << " and " << first << ": " << apart << " m apart, of "
                << bound << "\n";
      EXPECT_LT(apart, bound) << path.name << " and " << first;
    }
  }
}

TEST_F(Simulate, StopsAtRest) {
  // Held on all sides, almost without gravity and without a probe: at rest from the start.
  const Outcome outcome =
      run("scene.yaml --set 'probe.path=[]' --set 'gravity=[0, 0, -1e-6]' --set stop.rest_speed=0.001 --set "
          "stop.time=5 --out result");
  ASSERT_EQ(outcome.status, 0) << outcome.error;
  const auto summary = nlohmann::json::parse(readText(folder_ / "result/summary.json"));
  EXPECT_TRUE(summary["at_rest"]);
  EXPECT_NEAR(summary["simulated_time"].get<double>(), 0.1, 2e-3);
  EXPECT_EQ(readLines(folder_ / "result/probe.csv").size(), 1u) << "no probe, header only";
}

TEST_F(Simulate, DoesNotStopAtRestBeforeItsPathsEnd) {
  // As above, with a probe far away that waits until 0.2 s and then moves until 0.3 s.
  const Outcome outcome = run(
      "scene.yaml --set 'probe.path=[[0.2, 0, 0, 1], [0.3, 0, 0, 2]]' --set 'gravity=[0, 0, -1e-6]' --set "
      "stop.rest_speed=0.001 --set stop.time=5 --out result");
  ASSERT_EQ(outcome.status, 0) << outcome.error;
  const auto summary = nlohmann::json::parse(readText(folder_ / "result/summary.json"));
  EXPECT_TRUE(summary["at_rest"]);
  EXPECT_NEAR(summary["simulated_time"].get<double>(), 0.3 + 0.1, 2e-3);
}

TEST_F(Simulate, PrintsWithoutOut) {
  const Outcome outcome = run("scene.yaml");
  EXPECT_EQ(outcome.status, 0) << outcome.error;
  EXPECT_NE(outcome.output.find("active particles"), std::string::npos);
  const std::string machine = "processor " + processorName() + "; kernels for " + instructionSet() + "\n";
  EXPECT_NE(outcome.output.find(machine), std::string::npos) << outcome.output;
  const Outcome help = run("--help");
  EXPECT_EQ(help.status, 0);
  EXPECT_NE(help.output.find("summary.json"), std::string::npos);
  const Outcome options = run("--options");
  EXPECT_EQ(options.status, 0);
  EXPECT_NE(options.output.find("| `solver.tolerance` | `0.1` |"), std::string::npos) << options.output;
}

TEST_F(Simulate, RefusesBadInput) {
  write("typo.yaml", "cloth: {fabric: linen.yaml, partcles: [9, 9]}\n");
  write("broken.yaml", "cloth: [unclosed\n");
  expectRefused("typo.yaml", {"typo.yaml", "cloth.partcles"});
  expectRefused("broken.yaml", {"broken.yaml"});
  expectRefused("absent.yaml", {"absent.yaml"});
  expectRefused("scene.yaml --set solver.time_step=-1", {"solver.time_step", "-1", "> 0"});
  expectRefused("scene.yaml --set solver.time_step=0.1",
                {"scene.yaml: solver.time_step = 0.1: must be at most stop.time = 0.03"});
  expectRefused("scene.yaml --set nothing.here=1", {"nothing"});
  expectRefused("scene.yaml --set cloth.fabric=velvet_of_nowhere", {"cloth.fabric", "velvet_of_nowhere"});
  expectRefused("scene.yaml --bogus", {"--bogus"});
  expectRefused("", {"SCENE"});
}

TEST_F(Simulate, RefusesBadCommandLines) {
  const Outcome no_value = run("scene.yaml --set");
  EXPECT_EQ(no_value.status, 2);
  EXPECT_EQ(no_value.error, "simulate: the required argument for option '--set' is missing (see --help)\n");
  expectRefused("scene.yaml --set stop.time=0.002 stop.time=0.001",
                {"not expected", "stop.time=0.001"});  // a value for each --set
  expectRefused("scene.yaml --bogus=3", {"--bogus"});
  expectRefused("scene.yaml -x", {"-x"});
  expectRefused("scene.yaml --ou result", {"--ou"});  // names are not guessed
  expectRefused("scene.yaml --out other", {"--out", "more than once"});
  expectRefused("scene.yaml --set -1", {"--set: -1", "KEY=VALUE"});
  expectRefused("scene.yaml --set ''", {"--set", "KEY=VALUE"});
}

TEST_F(Simulate, RefusesEmptyNames) {
  for (const std::string option : {"--resume", "--save-state", "--replay"})
    expectRefused("scene.yaml " + option + " ''", {"simulate: " + option + ": must have a name"});
  expectRefused("''", {"simulate: SCENE: must have a name"});
  for (const std::string option : {"--out", "--plot", "--direction"}) {
    const Outcome outcome =
        runProgram("'" HAPTIC_CLOTH_KES_TEST "' linen.yaml --test tensile " + option + " ''");
    EXPECT_EQ(outcome.status, 2) << option;
    EXPECT_EQ(outcome.error, "kes_test: " + option + ": must have a name (see --help)\n");
  }
}

TEST_F(Simulate, TakesEverySpellingOfAnOption) {
  for (const char* arguments :
       {"--set=stop.time=0.004 scene.yaml", "--set stop.time=0.004 -- scene.yaml",
        "--set stop.time=2 scene.yaml --set=stop.time=0.004 --set gravity=[0,0,-1]"}) {
    SCOPED_TRACE(arguments);
    const Outcome outcome = run(arguments);
    EXPECT_EQ(outcome.status, 0) << outcome.error;
    EXPECT_NE(outcome.output.find("steps 4,"), std::string::npos) << outcome.output;
  }
  for (const char* arguments : {"--help", "-h", "scene.yaml --set nothing=1 --help"}) {
    SCOPED_TRACE(arguments);
    const Outcome outcome = run(arguments);
    EXPECT_EQ(outcome.status, 0) << outcome.error;
    for (const char* words : {"SCENE", "--set A.B=VALUE", "--save-state", "Exit status"})
      EXPECT_NE(outcome.output.find(words), std::string::npos) << outcome.output;
  }
}

TEST_F(Simulate, RefusesInstructionSetsItCannotUse) {
  std::string here, lacks;
  for (const SimdPath& path : simdPaths()) {
    if (path.available) here += (here.empty() ? "" : ", ") + path.name;
    if (!path.available) lacks = path.name;
  }
  expectRefused("scene.yaml", {"HAPTIC_CLOTH_SIMD = nonsense", "no such instruction set", here},
                "HAPTIC_CLOTH_SIMD=nonsense");
  if (!lacks.empty()) {  // the message is tested for all machines in simd_path_test.cpp
    expectRefused("scene.yaml", {"HAPTIC_CLOTH_SIMD = " + lacks, "lacks these instructions", here},
                  "HAPTIC_CLOTH_SIMD=" + lacks);
  }
}

TEST_F(Simulate, RefusesDirectoryItCannotWrite) {
  write("file", "occupied");
  const Outcome outcome = run("scene.yaml --out file/inside");
  EXPECT_EQ(outcome.status, 2);
  EXPECT_NE(outcome.error.find("file/inside"), std::string::npos) << outcome.error;
  EXPECT_EQ(readText(folder_ / "file"), "occupied");
}

// Limit as on a full disk: the table of steps fits, 1089 particles do not.
constexpr const char* kFullDisk = "ulimit -f 32 &&";
constexpr const char* kLargeTable = "--set cloth.particles=[33,33] --set stop.time=0.002";

TEST_F(Simulate, AFullDiskIsNamedAndLeavesNoFile) {
  const std::string run_it = std::string("scene.yaml ") + kLargeTable;
  const Outcome outcome = run(run_it + " --out out", kFullDisk);
  EXPECT_EQ(outcome.status, 4) << outcome.error;
  EXPECT_NE(outcome.error.find("particles.csv: cannot be written: File too large"), std::string::npos)
      << outcome.error;
  EXPECT_TRUE(fs::is_empty(folder_ / "out"));
  // The results of an earlier run stay, and no state is written without new ones.
  ASSERT_EQ(run("scene.yaml --out out").status, 0);
  const std::string before = readText(folder_ / "out/steps.csv");
  EXPECT_EQ(run(run_it + " --out out --save-state new.state", kFullDisk).status, 4);
  EXPECT_EQ(readText(folder_ / "out/steps.csv"), before);
  EXPECT_EQ(files("out").size(), 5u);
  EXPECT_FALSE(fs::exists(folder_ / "new.state"));
  const Outcome state = run(run_it + " --save-state new.state", kFullDisk);
  EXPECT_EQ(state.status, 4);
  EXPECT_NE(state.error.find("new.state: cannot be written: File too large"), std::string::npos)
      << state.error;
  EXPECT_FALSE(fs::exists(folder_ / "new.state"));
}

TEST_F(Simulate, AReportThatCannotBePrintedIsAnError) {
  const std::string no_room = "standard output: cannot be written: No space left on device";
  const std::string simulate = "'" HAPTIC_CLOTH_SIMULATE "' ", kes_test = "'" HAPTIC_CLOTH_KES_TEST "' ";
  for (const std::string& command : {simulate + "scene.yaml --save-state a.state", simulate + "--help",
                                     kes_test + "linen.yaml --test tensile", kes_test + "--help"}) {
    SCOPED_TRACE(command);
    const Outcome outcome = runProgram(command + " >/dev/full");
    EXPECT_EQ(outcome.status, 4);
    EXPECT_NE(outcome.error.find(no_room), std::string::npos) << outcome.error;
  }
  EXPECT_EQ(run("scene.yaml --resume a.state --out rest").status, 0) << "the state is whole";
  EXPECT_EQ(runProgram(simulate + "scene.yaml --out nothing_to_print >/dev/full").status, 0);
  const std::string without_reader =
      "/usr/bin/python3 -c 'import os, subprocess, sys; r, w = os.pipe(); os.close(r); "
      "sys.exit(subprocess.call(sys.argv[1:], stdout=w))' ";
  for (const std::string& command : {simulate + "--help", kes_test + "--help"})
    EXPECT_EQ(runProgram(without_reader + command).status, 4) << command;
}

TEST_F(Simulate, AUsersFileIsNotTakenForATemporaryOne) {
  fs::create_directories(folder_ / "out");
  for (const char* name : {"out/summary.json.partial", "out/steps.csv.partial", "curve.csv.partial"})
    write(name, "the user's");
  ASSERT_EQ(run("scene.yaml --out out").status, 0);
  ASSERT_EQ(
      runProgram("'" HAPTIC_CLOTH_KES_TEST "' linen.yaml --test tensile --out curve.csv >output.txt").status,
      0);
  for (const char* name : {"out/summary.json.partial", "out/steps.csv.partial", "curve.csv.partial"})
    EXPECT_EQ(readText(folder_ / name), "the user's") << name;
}

TEST_F(Simulate, AResultThatIsNoRegularFileIsRefused) {
  fs::create_directories(folder_ / "out/summary.json");
  const Outcome outcome = run("scene.yaml --out out");
  EXPECT_EQ(outcome.status, 2);
  EXPECT_NE(outcome.error.find("summary.json: must be a regular file"), std::string::npos) << outcome.error;
  EXPECT_EQ(files("out").size(), 1u);
}

TEST_F(Simulate, AStateMustNotReplaceAResult) {
  fs::create_directories(folder_ / "out");
  for (const char* state : {"out/steps.csv", "out/../out/mesh.ply"}) {
    const Outcome outcome = run(std::string("scene.yaml --out out --save-state ") + state);
    EXPECT_EQ(outcome.status, 2) << state;
    EXPECT_NE(outcome.error.find("must not be a result of --out"), std::string::npos) << outcome.error;
    EXPECT_TRUE(files("out").empty());
  }
}

TEST_F(Simulate, BadInputLeavesOldResultsAlone) {
  fs::create_directories(folder_ / "old");
  write("old/summary.json", "{}");
  EXPECT_EQ(run("scene.yaml --set solver.time_step=0 --out old").status, 2);
  EXPECT_EQ(readText(folder_ / "old/summary.json"), "{}");
}

TEST_F(Simulate, GoesOnFromASavedStateToTheLastBit) {
  ASSERT_EQ(run("scene.yaml --out whole").status, 0);
  const Outcome first = run("scene.yaml --set stop.time=0.013 --save-state half.state");
  ASSERT_EQ(first.status, 0) << first.error;
  const Outcome second = run("scene.yaml --resume half.state --set solver.threads=2 --out rest");
  ASSERT_EQ(second.status, 0) << second.error;
  const auto whole = nlohmann::json::parse(readText(folder_ / "whole/summary.json"));
  const auto rest = nlohmann::json::parse(readText(folder_ / "rest/summary.json"));
  for (const char* key : {"state_hash", "simulated_time", "energy", "probe_force", "support_force"}) {
    EXPECT_EQ(whole[key], rest[key]) << key;
  }
  EXPECT_EQ(rest["steps"], 17);
  // Only the steps that this run has simulated count: 17 of 1 ms.
  const double factor = rest["real_time_factor"], wall = rest["wall_time"];
  EXPECT_NEAR(factor * wall, 0.017, 1e-9);
  EXPECT_EQ(readText(folder_ / "whole/particles.csv"), readText(folder_ / "rest/particles.csv"));
  EXPECT_EQ(readLines(folder_ / "whole/probe.csv")[14], readLines(folder_ / "rest/probe.csv")[1]);
}

TEST_F(Simulate, AStateOfARunInRealTimeHasTheOptionsOfItsScene) {
  // No solver makes a step within a microsecond, so quality is given up.
  const std::string fast = "scene.yaml --set solver.time_step=1e-6 --set stop.rest_speed=0 --set stop.time=";
  const Outcome first = run(fast + "0.15 --real-time --save-state real.state --out real");
  ASSERT_EQ(first.status, 0) << first.error;
  const auto pace = nlohmann::json::parse(readText(folder_ / "real/summary.json"))["pace"];
  EXPECT_GT(pace["worst_rung"], 0);
  EXPECT_GE(pace["elapsed"], 0.15 - 0.005) << "never ahead of the clock, but for the last step";
  EXPECT_EQ(readLines(folder_ / "real/steps.csv").size(), 1u) << "the heading";
  const Outcome second = run(fast + "0.150005 --resume real.state --out rest");
  EXPECT_EQ(second.status, 0) << second.error;
}

TEST_F(Simulate, ReplaysARecording) {
  using namespace haptic_cloth;
  Simulation simulation(loadScene((folder_ / "scene.yaml").string()));
  std::string text;
  simulation.record([&text](const std::string& line) { text += line + '\n'; });
  for (const int length : {1, 2, 4, 4, 2, 1}) {
    followPaths(simulation, length);
    simulation.step(length);
  }
  const std::string cut = text;
  simulation.record(nullptr);
  write("session", text);
  write("other", cut + "end 0123456789abcdef\n");
  write("cut", cut);
  const Outcome outcome = run("scene.yaml --replay session --set solver.threads=2 --out result");
  ASSERT_EQ(outcome.status, 0) << outcome.error;
  const auto summary = nlohmann::json::parse(readText(folder_ / "result/summary.json"));
  EXPECT_EQ(text, cut + "end " + summary["state_hash"].get<std::string>() + '\n');
  EXPECT_EQ(outcome.output, "session: replayed to the same state\n");
  EXPECT_EQ(summary["steps"], 6);
  EXPECT_NEAR(summary["simulated_time"], 0.014, 1e-12);
  for (const auto& [file, message] : {std::pair("other", "ends with the state"), {"cut", "cut off"}}) {
    const Outcome differs = run("scene.yaml --replay " + std::string(file));
    EXPECT_EQ(differs.status, 3);
    EXPECT_NE(differs.error.find(message), std::string::npos) << differs.error;
  }
  fs::remove_all(folder_ / "result");
  expectRefused("scene.yaml --replay session --resume session", {"--resume", "--replay"});
  expectRefused("scene.yaml --replay session --real-time", {"--real-time", "--replay"});
  expectRefused("scene.yaml --replay session --set solver.time_budget=0.001",
                {"solver.time_budget", "must be 0"});
  expectRefused("scene.yaml --replay linen.yaml", {"linen.yaml", "must be a recording"});
  expectRefused("scene.yaml --replay /dev/zero", {"/dev/zero", "regular file"});
  expectRefused("scene.yaml --replay session --set gravity='[0,0,-1]'",
                {"session: gravity = [0, 0, -9.81]: the scene here has [0, 0, -1]"});
}

TEST_F(Simulate, ReplaysAFold) {
  using namespace haptic_cloth;
  write("scene.yaml",
        "cloth:\n"
        "  particles: [17, 5]\n"
        "  size: [0.08, 0.02]\n"
        "  fabric: linen.yaml\n"
        "  pins:\n"
        "    - {particles: edge_x0, velocity: [0.4, 0, 0]}\n"
        "    - {particles: edge_x1, velocity: [-0.4, 0, 0]}\n");
  Simulation simulation(loadScene((folder_ / "scene.yaml").string()));
  std::string text;
  simulation.record([&text](const std::string& line) { text += line + '\n'; });
  int pressed = 0;
  for (int step = 0; step < 100; ++step) pressed += simulation.step(1 + step % 2).self_contacts > 0 ? 1 : 0;
  EXPECT_GT(pressed, 20);
  simulation.record(nullptr);
  write("session", text);
  for (const char* threads : {"1", "2", "3"}) {
    const Outcome outcome =
        run("scene.yaml --replay session --out result --set solver.threads=" + std::string(threads));
    ASSERT_EQ(outcome.status, 0) << outcome.error;
    const auto summary = nlohmann::json::parse(readText(folder_ / "result/summary.json"));
    EXPECT_EQ("end " + summary["state_hash"].get<std::string>() + '\n', text.substr(text.rfind("end ")));
    EXPECT_EQ(summary["crossings"], 0);
    fs::remove_all(folder_ / "result");
  }
}

TEST_F(Simulate, KesTestTakesTheNameOfAFabric) {
  const std::string kes_test = "'" HAPTIC_CLOTH_KES_TEST "' ";
  EXPECT_EQ(runProgram(kes_test + "denim_a --test shear").status, 0);
  const Outcome outcome = runProgram(kes_test + "no_such --test shear");
  EXPECT_EQ(outcome.status, 2);
  EXPECT_NE(outcome.error.find("no_such: must be a fabric file or one of "), std::string::npos)
      << outcome.error;
  EXPECT_NE(outcome.error.find("denim_a, "), std::string::npos) << outcome.error;
}

TEST_F(Simulate, KesTestNamesTheWordsItKnows) {
  const std::string command =
      "'" HAPTIC_CLOTH_KES_TEST "' '" + (folder_ / "linen.yaml").string() + "' --test ";
  const std::string error = (folder_ / "error.txt").string();
  EXPECT_EQ(WEXITSTATUS(std::system((command + "bend 2>" + error).c_str())), 2);
  EXPECT_NE(readText(error).find("bend: must be one of bending, shear, tensile"), std::string::npos)
      << readText(error);
  EXPECT_EQ(WEXITSTATUS(std::system((command + "shear --mesh fine 2>" + error).c_str())), 2);
  EXPECT_NE(readText(error).find("--mesh: fine: must be one of coarsest, finest, mixed"), std::string::npos)
      << readText(error);
  EXPECT_EQ(WEXITSTATUS(std::system((command + "tensile >" + error).c_str())), 0);
  EXPECT_NE(readText(error).find("LT "), std::string::npos) << readText(error);
}

TEST_F(Simulate, KesTestLeavesNoHalfFile) {
  const std::string command = "'" HAPTIC_CLOTH_KES_TEST "' linen.yaml --test tensile --out ";
  const Outcome full = runProgram(command + "curve.csv >output.txt", "ulimit -f 8 &&");
  EXPECT_EQ(full.status, 4) << full.error;
  EXPECT_NE(full.error.find("curve.csv: cannot be written: File too large"), std::string::npos) << full.error;
  for (const std::string& name : files(".")) EXPECT_EQ(name.find("curve"), std::string::npos) << name;
  EXPECT_EQ(runProgram(command + "nowhere/curve.csv >output.txt").status, 2);
  ASSERT_EQ(mkfifo((folder_ / "fifo").c_str(), 0600), 0);
  EXPECT_EQ(runProgram(command + "fifo >output.txt").status, 2);
  EXPECT_TRUE(fs::is_fifo(folder_ / "fifo"));
  ASSERT_EQ(runProgram(command + "curve.csv >output.txt").status, 0);
  EXPECT_GT(readLines(folder_ / "curve.csv").size(), 100u);
}

/// Only files of its own kind are replaced: the fabric, a scene or a program would be lost.
TEST_F(Simulate, KesTestKeepsForeignFiles) {
  const std::string command = "'" HAPTIC_CLOTH_KES_TEST "' linen.yaml --test tensile";
  fs::create_symlink("linen.yaml", folder_ / "link.csv");
  write("mine.png", "no picture");
  write("mine.svg", "<?xml version=\"1.0\"?>\n<launch/>\n");
  for (const std::string option : {" --out linen.yaml", " --out link.csv", " --out scene.yaml",
                                   " --plot mine.png", " --plot mine.svg"}) {
    const Outcome outcome = runProgram(command + option);
    EXPECT_EQ(outcome.status, 2) << option;
    EXPECT_NE(outcome.error.find("what it holds would be lost"), std::string::npos) << outcome.error;
  }
  for (const std::string option : {" --plot linen.yaml", " --plot mine.sh", " --plot mine"}) {
    const Outcome outcome = runProgram(command + option);
    EXPECT_EQ(outcome.status, 2) << option;
    EXPECT_NE(outcome.error.find("must end in .pdf, .png or .svg"), std::string::npos) << outcome.error;
  }
  const Outcome both = runProgram(command + " --out both.png --plot ./both.png");
  EXPECT_EQ(both.status, 2);
  EXPECT_NE(both.error.find("must not be the file of --out"), std::string::npos) << both.error;
  EXPECT_FALSE(fs::exists(folder_ / "both.png"));
  EXPECT_EQ(readText(folder_ / "linen.yaml"), kFabric);
  EXPECT_EQ(readText(folder_ / "mine.png"), "no picture");
  write("curve.csv", "");  // an empty file, then a curve, is replaced
  for (int run = 0; run < 2; ++run) EXPECT_EQ(runProgram(command + " --out curve.csv").status, 0);
  EXPECT_GT(readLines(folder_ / "curve.csv").size(), 100u);
}

TEST_F(Simulate, KesTestNamesALawThatIsMissing) {
  write("bare.yaml",
        "source: test\nareal_density: 0.15\nthickness: 0.0005\ntensile: {stiffness: 1000}\n"
        "bending: {B: 0}\n");
  for (const std::string test : {"shear", "bending"}) {
    const Outcome outcome = runProgram("'" HAPTIC_CLOTH_KES_TEST "' bare.yaml --test " + test);
    EXPECT_EQ(outcome.status, 2);
    EXPECT_EQ(outcome.error, "bare.yaml: " + test + ": must have a stiffness or a loop for this test\n");
  }
}

/// A module in place of matplotlib ends Python before it reads the curve, which is longer than a pipe.
TEST_F(Simulate, KesTestNamesAPlotThatFailsAndLeavesNothing) {
  const std::string command = "'" HAPTIC_CLOTH_KES_TEST
                              "' linen.yaml --test shear --out \"it's.csv\" --plot \"it's.png\" >output.txt";
  const auto kept = [this] {
    std::string names;
    for (const std::string& name : files("."))
      if (name.find("it's") == 0) names += name + ' ';
    return names;
  };
  write("matplotlib.py", "raise SystemExit(1)\n");
  const Outcome failed = runProgram(command, "PYTHONPATH=.");
  EXPECT_EQ(failed.status, 3) << failed.error;
  EXPECT_NE(failed.error.find("it's.png: the plot failed"), std::string::npos) << failed.error;
  EXPECT_EQ(kept(), "");
  write("matplotlib.py", "import os, sys\nopen(sys.argv[-1], 'w').write('plot')\nos._exit(0)\n");
  const Outcome plotted = runProgram(command, "PYTHONPATH=.");
  EXPECT_EQ(plotted.status, 0) << plotted.error;
  EXPECT_EQ(kept(), "it's.csv it's.png ");
  EXPECT_EQ(readText(folder_ / "it's.png"), "plot");
}

TEST_F(Simulate, StatesAreReadFromRegularFilesOnly) {
  // The limits stop a program that reads endlessly or waits for a writer that never comes.
  const std::string guard = "ulimit -v 4000000 && timeout 300";
  ASSERT_EQ(mkfifo((folder_ / "fifo").c_str(), 0600), 0);
  for (const std::string name : {"/dev/zero", "/dev/null", "fifo", "."}) {
    expectRefused("scene.yaml --resume " + name, {name + ": must be a regular file"}, guard);
    expectRefused("scene.yaml --save-state " + name, {"must be a regular file"}, guard);
  }
  ASSERT_EQ(run("scene.yaml --set stop.time=0.002 --save-state a.state").status, 0);
  ASSERT_EQ(truncate((folder_ / "a.state").c_str(), off_t{1} << 36), 0);
  expectRefused("scene.yaml --resume a.state", {"a.state: has 68719476693 bytes of ", "has grown"}, guard);
}

/// One end of the strip turns over and through it. The state says then that it was made with
/// self-contact.
TEST_F(Simulate, RefusesAStartThatCrossesItself) {
  const std::string scene =
      "scene.yaml --set probe.path=[] --set cloth.pins='[edge_x0, {particles: edge_x1, turn: [0, -60, 0], "
      "centre: [0, 0, 0.05]}]' ";
  const std::string off = "--set cloth.self_contact=false ";
  const Outcome made = run(scene + off + "--set stop.time=0.06 --save-state crossed.state --out crossed");
  ASSERT_EQ(made.status, 0) << made.error;
  EXPECT_GT(nlohmann::json::parse(readText(folder_ / "crossed/summary.json"))["crossings"], 0);
  EXPECT_EQ(run(scene + off + "--set stop.time=0.062 --resume crossed.state").status, 0);

  std::vector<StateEntry> entries = stateEntries(readText(folder_ / "crossed.state"));
  const auto entry = std::find_if(entries.begin(), entries.end(),
                                  [](const auto& e) { return e.name == "cloth.self_contact"; });
  ASSERT_NE(entry, entries.end());
  entry->bytes[0] = 1;
  write("on.state", sealState(entries));
  expectRefused(scene + "--set stop.time=0.062 --resume on.state",
                {"on.state: cloth = ", " crossings, first of cells (", ") at [",
                 "must not pass through itself", "cannot untangle"});
}

TEST_F(Simulate, RefusesStatesItCannotUse) {
  ASSERT_EQ(run("scene.yaml --set stop.time=0.002 --save-state a.state").status, 0);
  const std::string saved = readText(folder_ / "a.state");
  write("cut.state", saved.substr(0, saved.size() / 2));
  expectRefused("scene.yaml --resume absent.state", {"absent.state", "No such file"});
  expectRefused("scene.yaml --resume cut.state", {"cut.state", "cut off"});
  expectRefused("scene.yaml --resume linen.yaml", {"linen.yaml", "does not begin"});
  expectRefused("scene.yaml --resume a.state --set gravity='[0,0,-1]'", {"a.state: gravity", "-9.81", "-1"});
  expectRefused("scene.yaml --save-state scene.yaml", {"scene.yaml", "would be lost"});
  expectRefused("scene.yaml --save-state nowhere/a.state", {"nowhere", "No such file"});
  expectRefused("scene.yaml --save-state /dev/full", {"/dev/full", "regular file"});
  EXPECT_EQ(readText(folder_ / "scene.yaml"), kScene);
  EXPECT_EQ(readText(folder_ / "a.state"), saved);
}

}  // namespace
}  // namespace haptic_cloth::simulate_test
