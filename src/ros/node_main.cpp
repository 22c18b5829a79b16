/// The node. Ends with 0 when asked to, 2 for bad parameters, 1 for anything else; force zero always last.
#include <ros/ros.h>

#include <atomic>
#include <csignal>
#include <cstdlib>
#include <thread>

#include "ros/program.h"
#include "ros/server.h"
#include "ros/shutdown.h"
#include "ros/steady_clock.h"

namespace {

/// For a node that has not begun. Static objects stay: a thread that still waits for the file system may
/// use them when it wakes. A master that does not answer is not waited for.
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
  // Waits for the master if there are parameters on the command line; until here a signal just ends it.
  ros::init(argc, argv, "haptic_cloth", ros::init_options::NoSigintHandler);
  std::signal(SIGXFSZ, SIG_IGN);  // a state that is too large for a file is no reason to end
  const haptic_cloth::Signals signals;
  std::atomic<bool> asked{false};
  haptic_cloth::answerShutdownCall(asked);
  if (!haptic_cloth::waitForMaster(signals)) return 0;
  ros::NodeHandle node, private_node("~");
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
