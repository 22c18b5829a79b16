/// A probe with a device of the impedance kind: pose in, force out.
#pragma once

#include <ros/publisher.h>

#include "ros/haptic/moving_gains.h"
#include "ros/haptic/probe_tick.h"
#include "ros/node/shared_state.h"

namespace haptic_cloth {

/// From the newest pose and snapshot of a probe to its wrench. One thread calls it.
class HapticProbe : public ProbeTick {
 public:
  /// @param settings of the probe  @param shared has a session for an impedance device
  HapticProbe(const std::string& frame_id, const ProbeSettings& settings, const ros::Publisher& reaction,
              SharedProbe& shared);

  void setOptions(const ProbeSettings& settings, const GainRamp& gains) override {
    gains_.set(settings, gains);
  }
  void tick(double now, bool paused) override;
  void sendLast() override;
  double heard() const override { return heard_; }
  bool isQuiet() const override { return felt_.force.isZero(0.0) && felt_.torque.isZero(0.0); }

 private:
  std::string frame_id_;
  MovingGains gains_;
  ros::Publisher reaction_;
  SharedProbe& shared_;
  HapticSession& session_;
  double heard_ = -1.0;  ///< see ProbeTick
  FeltForce felt_;       ///< of the last tick
};

}  // namespace haptic_cloth
