/// The measuring device of bench/latency. Criteria: it sends what a driver of the node's device sends, and
/// the file of the result is written by a complete run only.
#include <gtest/gtest.h>
#include <ros/ros.h>
#include <unistd.h>

#include <csignal>
#include <filesystem>
#include <fstream>
#include <sstream>

#include "ros/support/ros_test_support.h"

namespace haptic_cloth::latency_probe_test {
namespace {

namespace fs = std::filesystem;

class LatencyProbe : public testing::Test {
 protected:
  LatencyProbe()
      : folder_(fs::temp_directory_path() / ("haptic_cloth_latency_" + std::to_string(getpid()))),
        file_((folder_ / "latency.json").string()),
        reaction_(node_, "probe/reaction") {
    fs::create_directories(folder_);
    spinner_.start();
  }
  ~LatencyProbe() override { fs::remove_all(folder_); }

  std::vector<std::string> command(int seconds) const {
    return {programDirectory() + "/latency_probe", "_hang:=0.1", "_seconds:=" + std::to_string(seconds),
            "_out:=" + file_};
  }

  std::string result() const {
    std::ostringstream text;
    text << std::ifstream(file_).rdbuf();
    return text.str();
  }

  ros::NodeHandle node_;
  ros::AsyncSpinner spinner_{1};
  fs::path folder_;
  std::string file_;
  ReactionListener reaction_;
};

TEST_F(LatencyProbe, PressesTheClothThroughTheMapOfItsDevice) {
  Process probe(command(3));
  EXPECT_TRUE(waitFor([&] { return reaction_.force().z() > 0.1; })) << probe.output();
  EXPECT_EQ(probe.wait(), 0) << probe.output();
  EXPECT_NE(result().find("\"latency_p50_ms\""), std::string::npos) << result();
}

TEST_F(LatencyProbe, LeavesTheOldResultIfItIsInterrupted) {
  std::ofstream(file_) << "old";
  Process probe(command(30));
  ASSERT_TRUE(waitFor([&] { return reaction_.count() > 1000; })) << probe.output();  // at 1 kHz
  ros::Duration(2.0).sleep();                                                        // amid the measurement
  ASSERT_TRUE(probe.running()) << probe.output();
  probe.signal(SIGINT);
  EXPECT_EQ(probe.wait(), 1) << probe.output();
  EXPECT_EQ(result(), "old");
  EXPECT_NE(probe.output().find("interrupted"), std::string::npos) << probe.output();
  EXPECT_EQ(std::distance(fs::directory_iterator(folder_), fs::directory_iterator()), 1);
}

TEST_F(LatencyProbe, RefusesAFileThatItCannotWriteBeforeItMeasures) {
  file_ = (folder_ / "none" / "latency.json").string();
  Process probe(command(30));
  EXPECT_EQ(probe.wait(), 2) << probe.output();
}

}  // namespace
}  // namespace haptic_cloth::latency_probe_test

int main(int argc, char** argv) {
  testing::InitGoogleTest(&argc, argv);
  ros::init(argc, argv, "ros_latency_probe_test");
  return RUN_ALL_TESTS();
}
