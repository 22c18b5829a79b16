#include "ros/haptic/admittance_probe.h"

#include <ros/time.h>

#include "ros/node/conversions.h"

namespace haptic_cloth {

AdmittanceProbe::AdmittanceProbe(const NodeOptions& options, std::size_t number,
                                 const ros::Publisher& command, const ros::Publisher& reaction,
                                 SharedProbe& shared)
    : frame_id_(options.frame_id),
      gains_(options.probes[number]),
      command_(command),
      reaction_(reaction),
      shared_(shared),
      session_(*shared.admittance) {}

void AdmittanceProbe::tick(double now, bool paused) {
  const ros::Time stamp = ros::Time::now();  // that of `now`, whatever keeps the command from going out
  gains_.move(now, [this](const HapticOptions& options, double unit) {
    session_.setCheckedOptions(options, unit);  // checked when they were asked for
  });
  const StampedForce& hand = shared_.force.read();
  const StampedPose& device = shared_.pose.read();
  heard_ = hand.received;
  if (device.received >= 0.0) session_.setPose(device.pose, device.received);
  // A device all of whose poses were dropped is at an unknown place: no command may move it.
  const bool lost = device.received < 0.0 && shared_.sends_poses;
  // Scaled here, where the force scale moves: hand, tool and reaction have the same one in each tick.
  if (!lost) session_.setForce(forceAtProbe(gains_.device(), hand.frame_rotation, hand.force), hand.received);
  target_ = session_.tick(now, paused);
  const Wrench reaction = session_.reaction();
  sendReaction(hand, reaction);
  if (session_.hasStarted()) sendCommand(device, stamp);
  felt_.note(lost ? HapticStatus::NoPose : session_.status(), wrenchOnHand(gains_.device(), reaction),
             session_.forceShare());
  shared_.felt.write(felt_);
}

/// In the frame in which the device says where it is; in the cloth's where it does not.
void AdmittanceProbe::sendCommand(const StampedPose& device, const ros::Time& stamp) {
  geometry_msgs::PoseStamped command;
  command.header.stamp = stamp;
  command.header.frame_id = device.received >= 0.0 ? device.frame_id : frame_id_;
  const Quat into = device.frame_rotation.conjugate();
  const Pose target = {into * (target_.position - device.frame_position), into * target_.orientation};
  command.pose = toPose(poseForDriver(gains_.device(), target));
  command_.publish(command);
}

void AdmittanceProbe::sendReaction(const StampedForce& hand, const Wrench& wrench) {
  const bool answers = hand.received >= 0.0;
  reaction_.publish(toWrench(wrenchForDriver(gains_.device(), hand.frame_rotation, wrench),
                             answers ? hand.stamp : ros::Time::now(), answers ? hand.frame_id : frame_id_));
}

void AdmittanceProbe::sendLast() {
  sendReaction(StampedForce(), Wrench());
  if (session_.hasStarted()) sendCommand(shared_.pose.read(), ros::Time::now());
}

}  // namespace haptic_cloth
