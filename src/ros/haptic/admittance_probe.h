/// A probe with a device of the admittance kind: measured force in, pose out.
#pragma once

#include <ros/publisher.h>

#include "ros/haptic/moving_gains.h"
#include "ros/haptic/probe_tick.h"
#include "ros/node/shared_state.h"

namespace haptic_cloth {

/// From the newest force and snapshot of a probe to where its device is to go. One thread calls it.
class AdmittanceProbe : public ProbeTick {
 public:
  /// @param number of the probe in the scene  @param reaction for those who watch: what acts on the tool
  /// @param shared has a session for an admittance device
  AdmittanceProbe(const NodeOptions& options, std::size_t number, const ros::Publisher& command,
                  const ros::Publisher& reaction, SharedProbe& shared);

  void setOptions(const ProbeSettings& settings, const GainRamp& gains) override {
    gains_.set(settings, gains);
  }
  void tick(double now, bool paused) override;
  void sendLast() override;
  double heard() const override { return heard_; }
  bool isQuiet() const override {
    return session_.isAtRest() && felt_.force.isZero(0.0) && felt_.torque.isZero(0.0);
  }

 private:
  void sendCommand(const StampedPose& device, const ros::Time& stamp);
  void sendReaction(const StampedForce& hand, const Wrench& wrench);

  std::string frame_id_;
  MovingGains gains_;
  ros::Publisher command_, reaction_;
  SharedProbe& shared_;
  AdmittanceSession& session_;
  Pose target_;          ///< of the last tick, in the cloth's frame
  double heard_ = -1.0;  ///< see ProbeTick
  FeltForce felt_;       ///< of the last tick
};

}  // namespace haptic_cloth
