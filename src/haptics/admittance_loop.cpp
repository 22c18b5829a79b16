#include "haptics/admittance_loop.h"

#include <algorithm>
#include <cmath>

#include "contact/proxy.h"
#include "haptics/freshness.h"
#include "haptics/limits.h"
#include "haptics/tick_time.h"

namespace haptic_cloth {
namespace {

/// The cloth may hold with this many times what a hand may push with [-]: nobody gets through it because of a
/// limit. The device does not render this force, so no limit of the device's is needed.
constexpr double kHold = 2.0;

const HapticOptions& checked(const HapticOptions& options) {
  validateHapticOptions(options, "haptic options");
  return options;
}

HapticOptions clothOptions(HapticOptions options) {
  const AdmittanceOptions& tool = options.admittance;
  const double fastest = 2.0 * options.coupling_stiffness * tool.max_speed;
  options.max_force *= kHold;
  options.max_force_rate = std::max(options.max_force_rate, fastest);
  // The tool's place is known in the tick in which it gets there, and its damper is sure.
  options.passivity.loop_delay = 0.0;
  options.passivity.device_damping = tool.damping;
  return options;
}

HapticStatus judge(const AdmittanceOptions& options, const ForceSample& hand, double now) {
  if (hand.received < 0.0 || !std::isfinite(hand.received)) return HapticStatus::NoForce;
  const bool fresh = isFresh(hand.received, now, options.force_timeout) && hand.force.allFinite();
  return fresh ? HapticStatus::Free : HapticStatus::ForceStale;
}

}  // namespace

AdmittanceLoop::AdmittanceLoop(const HapticOptions& options)
    : options_(checked(options)),
      tool_(options.admittance),
      cloth_(clothOptions(options)),
      turn_filter_(options.velocity_time_constant, options.pose_timeout) {}

void AdmittanceLoop::setOptions(const HapticOptions& options, double unit) {
  options_ = options;
  tool_.setOptions(options.admittance);
  turn_filter_.setTimes(options.velocity_time_constant, options.pose_timeout);
  cloth_.setOptions(clothOptions(options), unit);
}

void AdmittanceLoop::place(const Pose& device, double received) {
  if (!(received > reported_.received)) return;
  const bool returns = received - reported_.received > options_.probe_timeout;
  reported_ = {device.position, received};
  turn(device.orientation);
  if (!started_ || returns) goToDevice();
}

/// Places the tool where the device is, unless that has followed its commands.
void AdmittanceLoop::goToDevice() {
  constexpr double kFollows = 5e-3;  // [m]
  if (started_ && (reported_.position - tool_.position()).norm() < kFollows) return;
  tool_.place(reported_.position);
  touch_.reset();
  lost_.reset();
  soft_ = 0.0;
  left_ = device_.received;
  ++device_.returns;
}

void AdmittanceLoop::tick(const ForceSample& hand, const ProbeSnapshot& newest, bool paused, double now) {
  const double elapsed = timeSince(last_tick_, now, 1.0 / options_.rate);
  const HapticStatus hand_status = judge(options_.admittance, hand, now);
  const bool fresh = hand_status == HapticStatus::Free;
  started_ = started_ || fresh;
  forgetAhead(reported_.received, now, options_.probe_timeout);
  const bool returns = fresh && now - device_.received > options_.probe_timeout;
  if (returns && !lost_) lost_ = touch_;  // a process that stood still has no tick in the silence
  if (returns && isFresh(reported_.received, now, options_.probe_timeout)) goToDevice();
  device_.position = tool_.position();
  device_.velocity = tool_.velocity();
  const Vec3 turned = turnBetween(turned_from_, device_.orientation);
  device_.angular_velocity = turn_filter_.update(turned, isTurnJump(turned.norm(), elapsed), now);
  turned_from_ = device_.orientation;
  if (fresh) device_.received = now;
  if (returns) ++device_.returns;
  DeviceSample here = device_;
  here.received = now;  // the tool is where it is, whatever the hand says
  // Nothing is known of the cloth at a new place until the solver has been there.
  ProbeSnapshot snapshot = newest.device_received > left_ ? newest : ProbeSnapshot();
  snapshot.holds = false;  // a tool with cloth in its grasp meets all of the force
  snapshot.trust = 1.0;    // cloth that resists weakly would let the tool through
  reaction_ = cloth_.tick(here, snapshot, paused || !fresh, now);
  status_ = fresh || paused ? cloth_.status() : hand_status;

  if (allowsForce(status_)) {
    soft_ = risen(soft_, elapsed, options_.soft_start);
    watchTouch(snapshot);
    moveTool(hand, snapshot, elapsed);
  } else {
    soft_ = 0.0;
    if (!lost_) lost_ = touch_;
    tool_.brake(elapsed);
  }
}

/// Remembers where the tool touches the cloth. After a fault, as a reset or silence of the hand, the cloth
/// may be elsewhere, and the probe touches nothing until it has been clear of it.
void AdmittanceLoop::watchTouch(const ProbeSnapshot& snapshot) {
  const Vec3 stretch = snapshot.proxy - snapshot.device;
  touch_.reset();
  if (status_ == HapticStatus::Contact && stretch.norm() > 0.0)
    touch_ = Touch{snapshot.proxy, stretch.normalized()};
  const bool again = lost_ && touch_ && touch_->out.dot(lost_->out) > 0.0;  // not from behind
  if (again || (lost_ && !lost_->isInside(tool_.position()))) lost_.reset();
}

/// Direction against which the tool must not move; zero: it is free. A hand that still pushes where nothing
/// resists would drive the device through the cloth and what it lies on.
Vec3 AdmittanceLoop::wayOut(const ProbeSnapshot& snapshot) const {
  if (lost_) return lost_->out;
  return status_ == HapticStatus::Inside ? snapshot.way_out : Vec3(Vec3::Zero());
}

void AdmittanceLoop::moveTool(const ForceSample& hand, const ProbeSnapshot& snapshot, double elapsed) {
  const double deadband = options_.admittance.deadband, norm = hand.force.norm();
  const Vec3 felt = norm > deadband ? Vec3((1.0 - deadband / norm) * hand.force) : Vec3(Vec3::Zero());
  Mat3 stiffness = Mat3::Zero(), damping = Mat3::Zero();
  if (status_ == HapticStatus::Contact) {
    const Mat3 held = Mat3::Identity() - snapshot.follow.topLeftCorner<3, 3>();
    stiffness = options_.coupling_stiffness * held;
    damping = options_.coupling_damping * held + options_.passivity.damping * Mat3::Identity();
  }
  Vec3 force = soft_ * limited(felt, options_.max_force) + reaction_;
  const Vec3 out = wayOut(snapshot);
  force -= std::min(0.0, force.dot(out)) * out;
  if (const double speed = tool_.velocity().dot(out); speed < 0.0) {
    constexpr double kStop = 1e9;  // [N·s/m]
    damping += kStop * out * out.transpose();
    force -= kStop * speed * out;
  }
  tool_.move(force, stiffness, damping, elapsed);
}

}  // namespace haptic_cloth
