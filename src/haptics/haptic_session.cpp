#include "haptic_cloth/haptic_session.h"

#include <cmath>

#include "contact/proxy.h"
#include "haptic_cloth/error.h"
#include "haptics/admittance_loop.h"
#include "haptics/freshness.h"
#include "haptics/velocity_filter.h"
#include "state/number_text.h"

namespace haptic_cloth {
namespace {

bool isPose(const Pose& pose) {
  const Eigen::Vector4d turn = pose.orientation.coeffs();
  return pose.position.norm() < kFarthestPose && turn.allFinite() && turn.norm() > 0.0;
}

/// Checks what setOptions() takes.
void check(const HapticOptions& options, double unit) {
  validateHapticOptions(options, "haptic options");
  if (unit > 0.0 && std::isfinite(unit)) return;
  throw InputError("haptic options", "unit", shortestText(unit), "must be finite and > 0");
}

}  // namespace

HapticSession::HapticSession(const Scene& scene, int probe, const HapticOptions& options)
    : ProbeSession(scene, probe, options, false),
      loop_(this->options()),
      filter_(std::make_unique<VelocityFilter>(options.velocity_time_constant, options.pose_timeout)),
      turn_filter_(std::make_unique<VelocityFilter>(options.velocity_time_constant, options.pose_timeout)) {}

HapticSession::~HapticSession() = default;

Wrench HapticSession::tick(const Pose& pose, double now, bool paused) {
  setPose(pose, now);
  return tick(now, paused);
}

Wrench HapticSession::tick(double now, bool paused) {
  forgetAhead(device_.received, now, options().pose_timeout);
  const Vec3 force = loop_.tick(device_, newestSnapshot(), paused, now);
  return {force, loop_.torque()};
}

void HapticSession::setPose(const Pose& pose, double received) {
  if (!isPose(pose) || !std::isfinite(received) || !(received > device_.received)) return;
  const double elapsed = received - device_.received;
  const Quat orientation = pose.orientation.normalized();
  const Vec3 moved = pose.position - device_.position, turned = turnBetween(device_.orientation, orientation);
  device_.received = received;
  device_.position = pose.position;
  device_.velocity = filter_->update(moved, isJump(moved.norm(), elapsed), received);
  device_.orientation = orientation;
  device_.angular_velocity = turn_filter_->update(turned, isTurnJump(turned.norm(), elapsed), received);
  if (elapsed > options().probe_timeout) ++device_.returns;
  sendDevice(device_);
}

void HapticSession::setOptions(const HapticOptions& options, double unit) {
  check(options, unit);
  setCheckedOptions(options, unit);
}

void HapticSession::setCheckedOptions(const HapticOptions& options, double unit) {
  takeOptions(options);
  loop_.setOptions(options, unit);
  for (VelocityFilter* filter : {filter_.get(), turn_filter_.get()})
    filter->setTimes(options.velocity_time_constant, options.pose_timeout);
}

AdmittanceSession::AdmittanceSession(const Scene& scene, int probe, const HapticOptions& options)
    : ProbeSession(scene, probe, options, true), loop_(std::make_unique<AdmittanceLoop>(this->options())) {
  loop_->turn(scene.probes[probe].orientation);
}

AdmittanceSession::~AdmittanceSession() = default;

Pose AdmittanceSession::tick(const Vec3& force, double now, bool paused) {
  setForce(force, now);
  return tick(now, paused);
}

Pose AdmittanceSession::tick(double now, bool paused) {
  forgetAhead(hand_.received, now, options().admittance.force_timeout);
  loop_->tick(hand_, newestSnapshot(), paused, now);
  sendDevice(loop_->device());
  return {loop_->position(), loop_->device().orientation};
}

void AdmittanceSession::setForce(const Vec3& force, double received) {
  if (!std::isfinite(received) || received < hand_.received) return;
  hand_.received = received;
  hand_.force = force;
}

void AdmittanceSession::setPose(const Pose& pose, double received) {
  if (!isPose(pose) || !std::isfinite(received)) return;
  loop_->place({pose.position, pose.orientation.normalized()}, received);
}

void AdmittanceSession::setOptions(const HapticOptions& options, double unit) {
  check(options, unit);
  setCheckedOptions(options, unit);
}

void AdmittanceSession::setCheckedOptions(const HapticOptions& options, double unit) {
  takeOptions(options);
  loop_->setOptions(options, unit);
}

bool AdmittanceSession::hasStarted() const { return loop_->started(); }

bool AdmittanceSession::isAtRest() const { return loop_->atRest(); }

Wrench AdmittanceSession::reaction() const { return {loop_->reaction(), loop_->torque()}; }

HapticStatus AdmittanceSession::status() const { return loop_->status(); }

double AdmittanceSession::forceShare() const { return loop_->forceShare(); }

}  // namespace haptic_cloth
