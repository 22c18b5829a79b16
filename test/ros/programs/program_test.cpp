/// Arguments of the node's programs. Criteria: help and unknown arguments keep a program from running,
/// with status 0 and 2; arguments of ROS and the option of the launch files do not.
#include "ros/programs/program.h"

#include <gtest/gtest.h>

namespace haptic_cloth::program_test {
namespace {

constexpr int kRan = 7;

int statusWith(std::vector<std::string> arguments) {
  arguments.insert(arguments.begin(), "hand");
  std::vector<char*> argv;
  for (std::string& argument : arguments) argv.push_back(&argument[0]);
  argv.push_back(nullptr);
  const auto run = [](int, char**) { return kRan; };
  return runProgram("hand", run, static_cast<int>(arguments.size()), argv.data());
}

TEST(Program, TakesWhatRosAndLaunchFilesGiveIt) {
  EXPECT_EQ(statusWith({}), kRan);
  EXPECT_EQ(statusWith({"_rate:=40", "probe/pose:=pose", "__name:=left", kWaitOnBadInput}), kRan);
}

TEST(Program, ShowsItsUsage) {
  EXPECT_EQ(statusWith({"--help"}), 0);
  EXPECT_EQ(statusWith({"_rate:=40", "-h"}), 0);
}

TEST(Program, RefusesOtherArguments) {
  EXPECT_EQ(statusWith({"bogus"}), 2);
  EXPECT_EQ(statusWith({"_rate=40"}), 2) << "a parameter is set with :=";
}

}  // namespace
}  // namespace haptic_cloth::program_test
