/// The node. Exit status: 0 if asked to end, 2 for bad parameters, 1 for any other error. The last
/// wrench is always zero.
#include <ros/ros.h>

#include <atomic>
#include <csignal>
#include <cstdlib>
#include <utility>

#include "ros/node/server.h"
#include "ros/node/shutdown.h"
#include "ros/programs/program.h"

namespace {

constexpr double kGoodbye = 2.0;  ///< longest time for signing off at the master [s]
/// Longest time for the whole end. The force ramps to zero within three seconds, and a file is
/// waited for one second.
constexpr double kEnd = 5.0;  // [s]

/// Ends a node that has not started. Static objects are not destroyed, because a thread that still
/// waits for the file system may use them when it wakes.
[[noreturn]] void endAtOnce() {
  haptic_cloth::endWithin(kGoodbye);
  ros::shutdown();
  std::_Exit(0);
}

int run(int argc, char** argv) {
  // init() waits for the master if there are parameters on the command line; until here a signal
  // just ends the process.
  ros::init(argc, argv, "haptic_cloth", ros::init_options::NoSigintHandler);
  std::signal(SIGXFSZ, SIG_IGN);  // a state too large for a file must not end the node
  const haptic_cloth::Signals signals;
  std::atomic<bool> asked{false};
  haptic_cloth::answerShutdownCall(asked);
  if (!haptic_cloth::waitForMaster(signals)) return 0;
  ros::NodeHandle node, private_node("~");
  bool ended = false;
  auto input = haptic_cloth::readParameters(private_node, [&] {
    ended = asked || !ros::ok() || signals.wait(0);
    return ended;
  });
  if (ended) endAtOnce();
  haptic_cloth::HapticClothServer server(node, private_node, std::move(*input));
  ROS_INFO("ready");
  while (!asked && ros::ok() && !signals.wait(100)) server.check();
  haptic_cloth::endWithin(kEnd);
  server.stop();
  return 0;
}

}  // namespace

int main(int argc, char** argv) { return haptic_cloth::runProgram("haptic_cloth", run, argc, argv); }
