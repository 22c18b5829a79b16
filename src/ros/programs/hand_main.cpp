/// The simulated hand as a node: publishes probe/pose at ~rate (1 kHz), subscribes to
/// probe/reaction.
#include <geometry_msgs/PoseStamped.h>
#include <geometry_msgs/WrenchStamped.h>
#include <ros/ros.h>

#include "haptic_cloth/haptics.h"
#include "ros/node/conversions.h"
#include "ros/node/steady_clock.h"
#include "ros/node/topics.h"
#include "ros/programs/hand_model.h"
#include "ros/programs/parameters.h"
#include "ros/programs/program.h"

namespace {

using haptic_cloth::Vec3;

/// A force older than this counts as zero, as in a device with a watchdog [s].
constexpr double kReactionTimeout = 0.05;

struct Reaction {
  double received = -1.0;  ///< steady clock [s]
  Vec3 force = Vec3::Zero();
};

int run(int argc, char** argv) {
  ros::init(argc, argv, "hand");
  haptic_cloth::endOnSigterm();
  ros::NodeHandle node, private_node("~");
  const auto options = haptic_cloth::ownOptions<haptic_cloth::HandOptions>(private_node);

  haptic_cloth::Mailbox<Reaction> mailbox;
  const ros::Subscriber reaction = node.subscribe<geometry_msgs::WrenchStamped>(
      haptic_cloth::topics::kReaction, haptic_cloth::topics::kReactionQueue,
      [&mailbox](const geometry_msgs::WrenchStamped::ConstPtr& message) {
        const auto& force = message->wrench.force;
        mailbox.write({haptic_cloth::steadyNow(), Vec3(force.x, force.y, force.z)});
      },
      ros::VoidConstPtr(), ros::TransportHints().tcpNoDelay());
  ros::Publisher pose = node.advertise<geometry_msgs::PoseStamped>(haptic_cloth::topics::kPose,
                                                                   haptic_cloth::topics::kPoseQueue);
  ros::AsyncSpinner spinner(1);
  spinner.start();

  haptic_cloth::HandModel hand(options);
  geometry_msgs::PoseStamped message;
  message.header.frame_id = options.frame_id;
  const double period = 1.0 / options.rate, start = haptic_cloth::steadyNow();
  for (long tick = 1; ros::ok(); ++tick) {
    haptic_cloth::sleepUntil(start + tick * period);
    const Reaction& newest = mailbox.read();
    const bool fresh =
        haptic_cloth::steadyNow() - newest.received < kReactionTimeout && newest.force.allFinite();
    const Vec3 force = fresh ? newest.force : Vec3(Vec3::Zero());
    message.pose = haptic_cloth::toPose(hand.step(handTarget(options, tick * period), force, period));
    message.header.stamp = ros::Time::now();
    pose.publish(message);
  }
  return 0;
}

}  // namespace

int main(int argc, char** argv) { return haptic_cloth::runProgram("hand", run, argc, argv); }
