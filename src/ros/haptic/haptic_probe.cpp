#include "ros/haptic/haptic_probe.h"

#include <ros/time.h>

#include "ros/node/conversions.h"

namespace haptic_cloth {

HapticProbe::HapticProbe(const std::string& frame_id, const ProbeSettings& settings,
                         const ros::Publisher& reaction, SharedProbe& shared)
    : frame_id_(frame_id),
      gains_(settings),
      reaction_(reaction),
      shared_(shared),
      session_(*shared.impedance) {}

void HapticProbe::tick(double now, bool paused) {
  gains_.move(now, [this](const HapticOptions& options, double unit) {
    session_.setCheckedOptions(options, unit);  // checked when they were asked for
  });
  const StampedPose& device = shared_.pose.read();
  heard_ = device.received;
  session_.setPose(device.pose, device.received);
  const Wrench wrench = session_.tick(now, paused);
  // Stated in the frame, axes and scale of the pose it answers. With the pose's stamp the receiver can tell
  // how old the force is; without a pose, the clock's.
  const bool answers = device.received >= 0.0;
  reaction_.publish(toWrench(wrenchForDriver(gains_.device(), device.frame_rotation, wrench),
                             answers ? device.stamp : ros::Time::now(),
                             answers ? device.frame_id : frame_id_));
  felt_.note(session_.status(), wrenchOnHand(gains_.device(), wrench), session_.forceShare());
  shared_.felt.write(felt_);
}

void HapticProbe::sendLast() { reaction_.publish(toWrench(Wrench(), ros::Time::now(), frame_id_)); }

}  // namespace haptic_cloth
