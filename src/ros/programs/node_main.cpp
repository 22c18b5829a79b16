/// The node. Exit status: 0 if asked to end, 2 for bad parameters, 1 for any other error. The last
/// wrench is always zero.
#include <ros/ros.h>

#include <atomic>
#include <csignal>
#include <cstdlib>
#include <thread>

#include "ros/node/server.h"
#include "ros/node/shutdown.h"
#include "ros/node/steady_clock.h"
#include "ros/programs/program.h"

namespace {

/// Ends a node that has not started. Static objects are not destroyed, because a thread that still
/// waits for the file system may use them when it wakes. A master that does not answer is waited
/// for at most 2 s.
[[noreturn]] void endAtOnce() {
  constexpr double kPatience = 2.0;  // [s]
  std::thread([] {
    haptic_cloth::sleepUntil(haptic_cloth::steadyNow() + kPatience);
    std::_Exit(0);
  }).detach();
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
  if (!haptic_cloth::waitForMaster(signals)) return 0;
  ros::NodeHandle node, private_node("~");
  haptic_cloth::answerShutdownCall(asked);
  bool ended = false;
  const auto options = haptic_cloth::readParameters(private_node, [&] {
    ended = asked || !ros::ok() || signals.wait(0);
    return ended;
  });
  if (ended) endAtOnce();
  haptic_cloth::HapticClothServer server(node, private_node, *options);
  ROS_INFO("ready");
  while (!asked && ros::ok() && !signals.wait(100)) server.check();
  server.stop();
  return 0;
}

}  // namespace

int main(int argc, char** argv) { return haptic_cloth::runProgram("haptic_cloth", run, argc, argv); }
