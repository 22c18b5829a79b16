/// Prints one line per second about the topics. With ~seconds > 0 it ends with a verdict, also as
/// exit status: 0 if all topics had their rates and finite numbers, otherwise 1.
#include <ros/callback_queue.h>
#include <ros/ros.h>

#include <cstdio>
#include <string>
#include <vector>

#include "haptic_cloth/error.h"
#include "ros/display/flow_meter.h"
#include "ros/node/steady_clock.h"
#include "ros/options/node_options.h"
#include "ros/programs/parameters.h"
#include "ros/programs/program.h"

namespace {

using haptic_cloth::MonitorOptions;

constexpr double kSettle = 0.5;  ///< messages that waited for the connections arrive in this time [s]
constexpr double kSilent = 2.0;  ///< time without all topics, after which it says which are missing [s]

/// Handles messages until `end` (steady clock [s]) or until ROS is shut down.
void spinUntil(double end) {
  for (double left = 1.0; ros::ok() && left > 0.0; left = end - haptic_cloth::steadyNow()) {
    ros::getGlobalCallbackQueue()->callAvailable(ros::WallDuration(std::min(left, 0.1)));
  }
}

void say(const std::string& line) {
  std::puts(line.c_str());
  std::fflush(stdout);
}

/// Names of the node's probes. Waits, because parameters are incomplete while a launch file is
/// loaded.
std::vector<std::string> findProbes(const ros::NodeHandle& node, const MonitorOptions& options) {
  const std::string served = node.resolveName(options.node);
  const double give_up = haptic_cloth::steadyNow() + options.patience;
  std::string wrong = served + ": no parameters";
  while (ros::ok() && haptic_cloth::steadyNow() < give_up) {
    XmlRpc::XmlRpcValue parameters;
    try {
      if (node.getParam(served, parameters)) {
        std::vector<std::string> names;
        const auto scene = haptic_cloth::parseNodeOptions(parameters, served + " (parameters)").scene;
        for (const haptic_cloth::ProbeOptions& probe : scene.probes) names.push_back(probe.name);
        return names;
      }
    } catch (const haptic_cloth::InputError& error) {
      wrong = error.what();
    }
    haptic_cloth::sleepUntil(haptic_cloth::steadyNow() + 0.1);
  }
  say(wrong + "; listening to the probe named probe alone");
  return {"probe"};
}

int run(int argc, char** argv) {
  ros::init(argc, argv, "monitor", ros::init_options::AnonymousName);
  haptic_cloth::endOnSigterm();
  ros::NodeHandle node, private_node("~");
  const auto options = haptic_cloth::ownOptions<MonitorOptions>(private_node);

  const std::vector<std::string> probes = findProbes(node, options);
  // One meter for the line, one for the whole time.
  haptic_cloth::FlowMeter second(node, probes, options.reaction_rate, options.display_rate);
  haptic_cloth::FlowMeter whole(node, probes, options.reaction_rate, options.display_rate);
  const double begin = haptic_cloth::steadyNow();
  bool said = false;
  while (ros::ok() && !whole.missing().empty() && haptic_cloth::steadyNow() < begin + options.patience) {
    spinUntil(haptic_cloth::steadyNow() + 0.1);
    if (said || whole.missing().empty() || haptic_cloth::steadyNow() < begin + kSilent) continue;
    say("no messages yet: " + whole.missing());
    said = true;
  }
  spinUntil(haptic_cloth::steadyNow() + kSettle);

  second.clear();
  whole.clear();
  const double start = haptic_cloth::steadyNow();
  double last = start;
  while (ros::ok() && (options.seconds == 0.0 || haptic_cloth::steadyNow() < start + options.seconds)) {
    spinUntil(last + 1.0);
    const double now = haptic_cloth::steadyNow();
    if (!ros::ok()) break;
    say(second.line(now - last));
    second.clear();
    last = now;
  }
  if (options.seconds == 0.0) return 0;
  if (last == start) {
    say("FAIL: ended before a second had passed");
    return 1;
  }
  bool passed = false;
  say(whole.verdict(last - start, passed));
  return passed ? 0 : 1;
}

}  // namespace

int main(int argc, char** argv) { return haptic_cloth::runProgram("monitor", run, argc, argv); }
