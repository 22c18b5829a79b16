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
      loop_(limitsAtProbe(settings.haptics, settings.device)) {}

void HapticProbe::tick(double now, bool paused) {
  gains_.move(now, [this](const HapticOptions& options, double unit) { loop_.setOptions(options, unit); });
  const StampedSample& device = shared_.device_for_haptics.read();
  heard_ = device.sample.received;
  const Vec3 force = loop_.tick(device.sample, shared_.snapshot.read(), paused, now);
  const Wrench wrench{force, loop_.torque()};
  // Stated in the frame, axes and scale of the pose it answers. With the pose's stamp the receiver can tell
  // how old the force is; without a pose, the clock's.
  const bool answers = device.sample.received >= 0.0;
  reaction_.publish(toWrench(wrenchForDriver(gains_.device(), device.frame_rotation, wrench),
                             answers ? device.stamp : ros::Time::now(),
                             answers ? device.frame_id : frame_id_));
  felt_.note(loop_.status(), wrench);
  shared_.felt.write(felt_);
}

void HapticProbe::sendLast() { reaction_.publish(toWrench(Wrench(), ros::Time::now(), frame_id_)); }

}  // namespace haptic_cloth
