#include "ros/haptic/admittance_probe.h"

#include <ros/time.h>

#include "ros/node/conversions.h"

namespace haptic_cloth {

AdmittanceProbe::AdmittanceProbe(const NodeOptions& options, std::size_t number,
                                 const ros::Publisher& command, const ros::Publisher& reaction,
                                 SharedProbe& shared)
    : frame_id_(options.frame_id),
      gains_(options.probes[number]),
      orientation_(options.scene.probes[number].orientation),
      command_(command),
      reaction_(reaction),
      shared_(shared),
      loop_(limitsAtProbe(options.probes[number].haptics, options.probes[number].device)) {}

void AdmittanceProbe::tick(double now, bool paused) {
  const ros::Time stamp = ros::Time::now();  // that of `now`, whatever keeps the command from going out
  gains_.move(now, [this](const HapticOptions& options, double unit) { loop_.setOptions(options, unit); });
  const StampedForce& hand = shared_.force.read();
  const StampedSample& device = shared_.device_for_haptics.read();
  const bool known = device.sample.received >= 0.0;
  heard_ = hand.sample.received;
  if (known) loop_.place(device.sample.position);
  loop_.tick(hand.sample, shared_.snapshot.read(), paused, now);
  const Wrench reaction{loop_.reaction(), loop_.torque()};
  sendReaction(hand, reaction);
  if (loop_.started()) sendCommand(device, stamp);
  DeviceSample tool = loop_.device();
  tool.orientation = known ? device.sample.orientation : orientation_;
  shared_.device_for_solver.write(tool);
  felt_.note(loop_.status(), reaction);
  shared_.felt.write(felt_);
}

/// In the frame in which the device says where it is; in the cloth's where it does not.
void AdmittanceProbe::sendCommand(const StampedSample& device, const ros::Time& stamp) {
  const bool known = device.sample.received >= 0.0;
  geometry_msgs::PoseStamped command;
  command.header.stamp = stamp;
  command.header.frame_id = known ? device.frame_id : frame_id_;
  const Quat into = device.frame_rotation.conjugate();
  const Quat orientation = known ? device.sample.orientation : orientation_;
  command.pose = toPose(positionForDriver(gains_.device(), into * (loop_.position() - device.frame_position)),
                        orientationForDriver(gains_.device(), into * orientation));
  command_.publish(command);
}

void AdmittanceProbe::sendReaction(const StampedForce& hand, const Wrench& wrench) {
  const bool answers = hand.sample.received >= 0.0;
  reaction_.publish(toWrench(wrenchForDriver(gains_.device(), hand.frame_rotation, wrench),
                             answers ? hand.stamp : ros::Time::now(), answers ? hand.frame_id : frame_id_));
}

void AdmittanceProbe::sendLast() {
  sendReaction(StampedForce(), Wrench());
  if (loop_.started()) sendCommand(shared_.device_for_haptics.read(), ros::Time::now());
}

}  // namespace haptic_cloth
