/// The main of every gtest program without ROS: catkin links gtest, but not gtest_main.
/// --path=SET runs the tests on that path of the kernels. Where the machine lacks it, one test is skipped and
/// the exit status is 77, by which ctest knows that nothing was tested.
#include <gtest/gtest.h>

#include <cstdlib>
#include <iostream>
#include <string>

#include "haptic_cloth/machine.h"
#include "simd/path.h"

namespace {

enum ExitCode { kNoSuchPath = 2, kSkipped = 77 };

std::string wanted_path;  ///< empty: the machine's best
bool available = true;

TEST(SimdPath, IsTheOneAskedFor) {
  if (!available) GTEST_SKIP() << "this machine does not have " << wanted_path;
  if (!wanted_path.empty()) {
    EXPECT_EQ(haptic_cloth::instructionSet(), wanted_path);
  }
}

/// @return false where this build has no such path
bool setPath(const std::string& name) {
  for (const haptic_cloth::SimdPath& path : haptic_cloth::simdPaths()) {
    if (path.name != name) continue;
    wanted_path = name;
    available = path.available;
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
  if (!available) {
    testing::GTEST_FLAG(filter) = "SimdPath.IsTheOneAskedFor";
  } else {
    std::cout << "processor " << haptic_cloth::processorName() << "; kernels for "
              << haptic_cloth::instructionSet() << std::endl;
  }
  const int status = RUN_ALL_TESTS();
  return status == 0 && !available ? kSkipped : status;
}
