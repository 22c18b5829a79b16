/// Rules of the source tree that the compiler does not check (docs/architecture.md).
#include <gtest/gtest.h>

#include <algorithm>
#include <filesystem>
#include <fstream>
#include <regex>
#include <set>
#include <string>
#include <vector>

#include "haptic_cloth/fabric.h"
#include "haptic_cloth/scene.h"

namespace haptic_cloth::structure_test {
namespace {

namespace fs = std::filesystem;

const fs::path kRoot = HAPTIC_CLOTH_SOURCE_DIR;

struct SourceFile {
  fs::path path;  ///< relative to the root
  std::vector<std::string> lines;
};

std::vector<SourceFile> readFiles(const std::vector<std::string>& folders,
                                  const std::set<std::string>& endings) {
  std::vector<SourceFile> files;
  for (const std::string& folder : folders) {
    if (!fs::exists(kRoot / folder)) continue;
    for (const auto& entry : fs::recursive_directory_iterator(kRoot / folder)) {
      if (!entry.is_regular_file() || endings.count(entry.path().extension().string()) == 0) continue;
      SourceFile file{fs::relative(entry.path(), kRoot), {}};
      std::ifstream stream(entry.path());
      for (std::string line; std::getline(stream, line);) file.lines.push_back(line);
      files.push_back(file);
    }
  }
  std::sort(files.begin(), files.end(),
            [](const SourceFile& a, const SourceFile& b) { return a.path < b.path; });
  return files;
}

std::vector<SourceFile> code(const std::vector<std::string>& folders) {
  return readFiles(folders, {".h", ".cpp"});
}

void expectNoLine(const std::vector<SourceFile>& files, const std::string& pattern, const std::string& rule) {
  const std::regex forbidden(pattern);
  for (const SourceFile& file : files) {
    for (std::size_t k = 0; k < file.lines.size(); ++k) {
      EXPECT_FALSE(std::regex_search(file.lines[k], forbidden))
          << file.path.string() << ":" << k + 1 << ": " << rule << "\n  " << file.lines[k];
    }
  }
}

TEST(Structure, FindsTheSources) { EXPECT_GT(code({"src", "include"}).size(), 20u); }

TEST(Structure, NoIncludeLeavesItsLayer) {
  expectNoLine(code({"src"}), R"(^\s*#\s*include\s*"\.)", "a relative path gets around cmake/layers.cmake");
}

TEST(Structure, SolverKnowsNoCloth) {
  expectNoLine(code({"src/solver", "src/parallel"}),
               R"(^\s*#\s*include\s*"haptic_cloth/(?!(options|report)\.h))", "the solver knows no cloth");
}

TEST(Structure, PublicHeadersStandAlone) {
  expectNoLine(code({"include"}), R"(^\s*#\s*include\s*[<"](?!haptic_cloth/|Eigen/|\w+>))",
               "a user of the header would have to find it");
}

/// Debian keeps the headers of ROS where every compiler looks.
TEST(Structure, NoRosOutsideItsFolder) {
  std::vector<SourceFile> files = code({"src", "include", "examples", "bench", "test"});
  files.erase(std::remove_if(files.begin(), files.end(),
                             [](const SourceFile& file) {
                               return file.path.string().rfind("src/ros", 0) == 0 ||
                                      file.path.string().rfind("test/ros", 0) == 0;
                             }),
              files.end());
  expectNoLine(
      files,
      "^\\s*#\\s*include\\s*[<\"]"
      "((ros|tf|tf2|tf2_ros|tf2_geometry_msgs|nodelet|pluginlib|class_loader|dynamic_reconfigure|"
      "diagnostic_updater|interactive_markers|message_filters|rosbag|actionlib|[a-z0-9_]+_msgs|std_srvs)/"
      "|haptic_cloth/[A-Z])",  // generated messages begin with a capital
      "only src/ros knows ROS");
}

TEST(Structure, OpenMpStaysInOneHeader) {
  std::vector<SourceFile> files = code({"src", "include", "examples", "bench", "test"});
  const std::set<fs::path> allowed = {"src/parallel/parallel_for.h",
                                      "bench/kernel_times/openmp_costs.cpp",  // which measures it
                                      "bench/kernel_times/limits.cpp"};       // `omp simd`, no threads
  files.erase(std::remove_if(files.begin(), files.end(),
                             [&](const SourceFile& file) { return allowed.count(file.path) == 1; }),
              files.end());
  expectNoLine(files, "^\\s*#\\s*pragma\\s+omp|[<\"]omp\\.h[>\"]", "OpenMP belongs into parallel_for.h");
}

TEST(Structure, NoUsingNamespaceStd) {
  expectNoLine(code({"src", "include", "examples", "bench", "test"}), "^\\s*using\\s+namespace\\s+std\\b",
               "no using namespace std");
}

TEST(Structure, TestFilesHaveNamespacesOfTheirNames) {
  int files = 0;
  for (const SourceFile& file : code({"test"})) {
    const std::string stem = file.path.stem().string();
    if (stem.size() < 5 || stem.substr(stem.size() - 5) != "_test") continue;
    ++files;
    EXPECT_EQ(std::count(file.lines.begin(), file.lines.end(), "namespace haptic_cloth::" + stem + " {"), 1)
        << file.path.string() << ": several such files are compiled as one";
  }
  EXPECT_GT(files, 100);
}

TEST(Structure, OnlyRunToolCatches) {
  std::vector<SourceFile> others = code({"src/tools"});
  const auto is_run_tool = [](const SourceFile& file) { return file.path.filename() == "run_tool.h"; };
  const auto end = std::remove_if(others.begin(), others.end(), is_run_tool);
  ASSERT_EQ(others.end() - end, 1);
  others.erase(end, others.end());
  expectNoLine(others, "\\bcatch\\s*\\(", "the common main of the tools has the only catch");
}

TEST(Structure, LibraryDoesNotPrint) {
  expectNoLine(code({"src/parallel", "src/simd", "src/state", "src/solver", "src/fabric", "src/mesh",
                     "src/energy", "src/contact", "src/sim", "src/haptics", "include"}),
               "std::c(out|err|log)\\b|\\bprintf\\(|\\bexit\\(", "only src/ros and src/tools print");
}

std::vector<fs::path> configurations(const std::string& folder) {
  std::vector<fs::path> files;
  for (const auto& entry : fs::directory_iterator(kRoot / "config" / folder)) {
    if (entry.path().extension() == ".yaml") files.push_back(entry.path());
  }
  std::sort(files.begin(), files.end());
  return files;
}

TEST(Configurations, EveryFabricLoads) {
  const auto files = configurations("fabrics");
  EXPECT_FALSE(files.empty());
  for (const fs::path& file : files) {
    SCOPED_TRACE(file.string());
    Fabric fabric;
    ASSERT_NO_THROW(fabric = loadFabric(file.string()));
    EXPECT_EQ(fabric.name, file.stem().string());
    EXPECT_FALSE(fabric.source.empty());
  }
}

TEST(Configurations, EverySceneLoads) {
  const auto files = configurations("scenes");
  EXPECT_FALSE(files.empty());
  for (const fs::path& file : files) {
    SCOPED_TRACE(file.string());
    EXPECT_NO_THROW(validateScene(loadScene(file.string()), file.string()));
  }
}

}  // namespace
}  // namespace haptic_cloth::structure_test
