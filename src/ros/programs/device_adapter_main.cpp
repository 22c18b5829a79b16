/// The adapter as a node. Exit status: 0 if asked to end, 2 for bad parameters, 1 for any other
/// error. The last force is always zero.
#include <ros/ros.h>

#include <string>
#include <utility>

#include "haptic_cloth/error.h"
#include "ros/input/device_adapter.h"
#include "ros/node/shutdown.h"
#include "ros/node/topics.h"
#include "ros/programs/parameters.h"
#include "ros/programs/program.h"

namespace {

constexpr long kLook = 10;    ///< interval between two looks of the adapters [ms]
constexpr double kEnd = 5.0;  ///< longest time for the zeros and for signing off at the master [s]

int run(int argc, char** argv) {
  ros::init(argc, argv, "device_adapter", ros::init_options::NoSigintHandler);
  const haptic_cloth::Signals signals;
  std::atomic<bool> asked{false};
  haptic_cloth::answerShutdownCall(asked);
  if (!haptic_cloth::waitForMaster(signals)) return 0;
  ros::NodeHandle node, private_node("~");
  const auto options = haptic_cloth::ownOptions<haptic_cloth::AdapterOptions>(private_node);

  for (const auto& [ours, drivers] :
       {std::pair(haptic_cloth::topics::kPose, haptic_cloth::topics::kDevicePose),
        std::pair(haptic_cloth::topics::kReaction, haptic_cloth::topics::kDeviceForce)}) {
    if (node.resolveName(ours) != node.resolveName(drivers)) continue;
    throw haptic_cloth::InputError("remapping", drivers, node.resolveName(drivers),
                                   std::string("must be another topic than ") + ours);
  }
  haptic_cloth::PoseAdapter poses(node, options);
  haptic_cloth::ForceAdapter forces(node, options);
  // Two threads, so that a pose does not wait for a force.
  ros::AsyncSpinner spinner(2);
  spinner.start();
  while (!asked && ros::ok() && !signals.wait(kLook)) {
    poses.look();
    forces.look();
  }
  haptic_cloth::endWithin(kEnd);
  forces.end();
  spinner.stop();
  return 0;
}

}  // namespace

int main(int argc, char** argv) { return haptic_cloth::runProgram("device_adapter", run, argc, argv); }
