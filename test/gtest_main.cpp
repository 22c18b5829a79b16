/// The main of every gtest program without ROS: catkin links gtest, but not gtest_main.
/// --path=SET runs the tests on that path of the kernels. Where the machine lacks it, or takes it without the
/// option, one test is skipped and the exit status is 77, by which ctest knows that nothing was tested.
#include <gtest/gtest.h>

#include <cstdlib>
#include <iostream>
#include <string>
#include <vector>

#include "haptic_cloth/machine.h"
#include "simd/path.h"

namespace {

enum ExitCode { kNoSuchPath = 2, kSkipped = 77 };

std::string wanted_path;  ///< empty: the one that the machine takes
std::string why_skipped;  ///< empty: the tests run

TEST(SimdPath, IsTheOneAskedFor) {
  if (!why_skipped.empty()) GTEST_SKIP() << why_skipped;
  if (!wanted_path.empty()) {
    EXPECT_EQ(haptic_cloth::instructionSet(), wanted_path);
  }
}

/// @return false where this build has no such path
bool setPath(const std::string& name) {
  const std::vector<haptic_cloth::SimdPath> paths = haptic_cloth::simdPaths();
  const std::string taken = haptic_cloth::choosePath(paths, std::getenv("HAPTIC_CLOTH_SIMD")).name;
  for (const haptic_cloth::SimdPath& path : paths) {
    if (path.name != name) continue;
    wanted_path = name;
    if (!path.available) why_skipped = "this machine does not have " + name;
    if (name == taken) why_skipped = "without --path the tests run on " + name;
    setenv("HAPTIC_CLOTH_SIMD", name.c_str(), 1);
    return true;
  }
  return false;
}

}  // namespace

int main(int argc, char** argv) {
  testing::InitGoogleTest(&argc, argv);
  const std::string option = "--path=";
  for (int k = 1; k < argc; ++k) {
    const std::string argument = argv[k];
    if (argument.rfind(option, 0) != 0 || setPath(argument.substr(option.size()))) continue;
    std::cerr << argument << ": this build has no such path" << std::endl;
    return kNoSuchPath;
  }
  if (!why_skipped.empty()) {
    testing::GTEST_FLAG(filter) = "SimdPath.IsTheOneAskedFor";
  } else {
    std::cout << "processor " << haptic_cloth::processorName() << "; kernels for "
              << haptic_cloth::instructionSet() << std::endl;
  }
  const int status = RUN_ALL_TESTS();
  return status == 0 && !why_skipped.empty() ? kSkipped : status;
}
