#include <algorithm>
#include <cmath>

#include "haptic_cloth/haptics.h"
#include "haptics/coupling_model.h"
#include "haptics/freshness.h"
#include "haptics/limits.h"
#include "haptics/tick_time.h"
#include "sim/turn_spring.h"

namespace haptic_cloth {
namespace {

/// A new snapshot's force is blended in over this share of the time between it and the last one, [-],
constexpr double kHandoverShare = 0.5;
/// but no less and no longer than this [s]: a jump of one solve is felt over two ticks.
constexpr double kMinHandover = 0.0015, kMaxHandover = 0.02;

bool isFinite(const DeviceSample& sample) {
  return std::isfinite(sample.received) && sample.position.allFinite() && sample.velocity.allFinite() &&
         sample.orientation.coeffs().allFinite() && sample.angular_velocity.allFinite();
}

bool isFinite(const ProbeSnapshot& snapshot) {
  return std::isfinite(snapshot.taken) && std::isfinite(snapshot.device_received) &&
         snapshot.device.allFinite() && snapshot.proxy.allFinite() &&
         snapshot.device_orientation.coeffs().allFinite() &&
         snapshot.proxy_orientation.coeffs().allFinite() && std::isfinite(snapshot.turn_radius) &&
         snapshot.drift.allFinite() && snapshot.follow.allFinite() && snapshot.force.allFinite() &&
         snapshot.torque.allFinite();
}

/// Tells whether the device is farther from the snapshot's pose than a hand can move or turn it: the
/// snapshot then describes the cloth at another place.
bool hasJumped(const DeviceSample& device, const ProbeSnapshot& snapshot) {
  const double elapsed = device.received - snapshot.device_received;
  return isJump((device.position - snapshot.device).norm(), elapsed) ||
         (snapshot.turn_radius > 0.0 &&
          isTurnJump(device.orientation.angularDistance(snapshot.device_orientation), elapsed));
}

HapticStatus judge(const HapticOptions& options, const DeviceSample& device, const ProbeSnapshot& snapshot,
                   bool paused, double now) {
  if (paused) return HapticStatus::Paused;
  if (!isFinite(device) || device.received < 0.0) return HapticStatus::NoPose;
  if (!isFresh(device.received, now, options.pose_timeout)) return HapticStatus::PoseStale;
  if (!isFinite(snapshot) || snapshot.taken < 0.0) return HapticStatus::NoSnapshot;
  if (!isFresh(snapshot.taken, now, options.snapshot_timeout)) return HapticStatus::SnapshotStale;
  if (!snapshot.contact) return snapshot.inside ? HapticStatus::Inside : HapticStatus::Free;
  return hasJumped(device, snapshot) ? HapticStatus::NoSnapshot : HapticStatus::Contact;
}

Pose placeOf(const ProbeSnapshot& snapshot) { return {snapshot.device, snapshot.device_orientation}; }

Wrench wrenchOf(const ProbeSnapshot& snapshot) { return {snapshot.force, snapshot.torque}; }

}  // namespace

const char* toString(HapticStatus status) {
  switch (status) {
    case HapticStatus::NoPose:
      return "no pose";
    case HapticStatus::NoForce:
      return "no force";
    case HapticStatus::ForceStale:
      return "force stale";
    case HapticStatus::NoSnapshot:
      return "no snapshot";
    case HapticStatus::PoseStale:
      return "pose stale";
    case HapticStatus::SnapshotStale:
      return "snapshot stale";
    case HapticStatus::Paused:
      return "paused";
    case HapticStatus::Inside:
      return "inside the cloth";
    case HapticStatus::Free:
      return "free";
    case HapticStatus::Contact:
      return "contact";
  }
  return "unknown";
}

bool allowsForce(HapticStatus status) {
  return status == HapticStatus::Inside || status == HapticStatus::Free || status == HapticStatus::Contact;
}

HapticLoop::HapticLoop(const HapticOptions& options)
    : options_(options),
      passivity_(options.passivity, 1.0 / options.rate),
      torque_passivity_(options.passivity, 1.0 / options.rate) {
  validateHapticOptions(options, "haptic options");
}

void HapticLoop::setOptions(const HapticOptions& options, double unit) {
  options_ = options;
  wrench_.force /= unit;
  wrench_.torque /= unit;
  torque_span_ /= unit;
  // handover_ is a difference between two wrenches of the coupling, which knows no scale of the hand.
  passivity_.setOptions(options.passivity, 1.0 / options.rate, unit);
  torque_passivity_.setOptions(options.passivity, 1.0 / options.rate, unit);
}

Vec3 HapticLoop::tick(const DeviceSample& device, const ProbeSnapshot& snapshot, bool paused, double now) {
  const double elapsed = timeSince(last_tick_, now, 1.0 / options_.rate);
  status_ = judge(options_, device, snapshot, paused, now);
  // A snapshot of another cloth counts as missing for one tick, so that the force starts softly.
  if (snapshot.cloth != snapshot_.cloth) status_ = HapticStatus::NoSnapshot;
  const bool good = allowsForce(status_);

  // A fault restarts the soft start. Its limit holds for the target only; the force comes down by the ramp.
  soft_ = good ? risen(soft_, elapsed, options_.soft_start) : 0.0;

  Wrench target;
  double rate = options_.max_force_rate;
  if (good && snapshot.taken != snapshot_.taken && snapshot_.taken >= 0.0 && isFinite(snapshot_))
    taken_ = takenSince(snapshot_, placeOf(snapshot), wrenchOf(snapshot));
  if (status_ == HapticStatus::Contact) {
    target = contactWrench(device, snapshot, now);
  } else if (good) {
    observe(device, {}, taken_, 1.0);
    passivity_.forgive();
    torque_passivity_.forgive();
  } else {
    passivity_.reset();
    torque_passivity_.reset();
    taken_ = taken_before_ = recovered_ = {};
    rate = std::min(rate, options_.max_force / options_.ramp_time);
  }
  wrench_.force = approach(wrench_.force, target.force, rate * elapsed);
  wrench_.torque = approach(wrench_.torque, target.torque, torqueRate(rate) * elapsed);
  passivity_.sent(joined(wrench_.force, Vec3::Zero()));
  torque_passivity_.sent(joined(wrench_.force, wrench_.torque / kTurnArm));
  snapshot_ = snapshot;
  return wrench_.force;
}

/// Adds the energy that is taken on the way from a solve to another place, by the mean of the wrenches at
/// both ends: exact for springs. What is beyond the limits cannot be felt and does not count.
HapticLoop::Energy HapticLoop::takenSince(const ProbeSnapshot& solve, const Pose& place,
                                          const Wrench& wrench) const {
  const Wrench start = withinLimits(wrenchOf(solve)), end = withinLimits(wrench);
  const double by_force = -0.5 * (start.force + end.force).dot(place.position - solve.device);
  const double by_torque =
      -0.5 * (start.torque + end.torque).dot(turnBetween(solve.device_orientation, place.orientation));
  return {taken_.by_force + by_force, taken_.by_torque + by_torque};
}

Wrench HapticLoop::withinLimits(const Wrench& wrench) const {
  const double limit = soft_ * options_.max_force;
  return {limited(wrench.force, limit),
          limited(shareWithin(wrench.force, limit) * wrench.torque, soft_ * options_.max_torque)};
}

/// Largest change of the torque [N·m/s]: the same share of its limit as `force_rate` is of the force's.
/// A torque above a lowered limit, which may be zero, goes down at the pace of the limit it had.
double HapticLoop::torqueRate(double force_rate) {
  if (!(wrench_.torque.norm() > options_.max_torque)) torque_span_ = 0.0;
  torque_span_ = std::max(torque_span_, options_.max_torque);
  return force_rate / options_.max_force * torque_span_;
}

/// Coupling and passivity within the limits. The torque is cut by the same factor as the coupling's
/// force: both come from the same contact.
Wrench HapticLoop::contactWrench(const DeviceSample& device, const ProbeSnapshot& snapshot, double now) {
  const double limit = soft_ * options_.max_force;
  const Wrench newest = couplingWrench(options_, device, snapshot);
  const Wrench wrench = handedOver(device, snapshot, newest, now);
  const HeldEnergies held = heldEnergies(options_, device, snapshot, limit);
  // Where the limit rises, as after the start, the loop lets the spring give more back.
  taken_.by_force += held.moved.coupling - springEnergy(options_, device, snapshot, limit_);
  limit_ = limit;
  observe(device, held, takenSince(snapshot, {device.position, device.orientation}, newest), snapshot.trust);
  const auto [gain, torque_gain] = gains();
  const Vec3 damping = passivity_.damping().head<3>();
  const Vec3 torque_damping = kTurnArm * torque_passivity_.damping().tail<3>();
  return {limited(gain * limited(wrench.force, limit) + damping, limit),
          limited(torque_gain * shareWithin(wrench.force, limit) * wrench.torque + torque_damping,
                  soft_ * options_.max_torque)};
}

/// Shows the pose to both controllers. That of the force counts the work of the force alone: otherwise a
/// twist could pay for a buzz along the force, and a debt of the torque would weaken the force. That of the
/// torque counts the work of both, because cloth gives back by a turn what a motion has put in.
void HapticLoop::observe(const DeviceSample& device, const HeldEnergies& held, const Energy& taken,
                         double trust) {
  turned_ += turnBetween(orientation_, device.orientation);
  orientation_ = device.orientation;
  const Gains before = gains();
  Energy passed{before.force * (taken.by_force - taken_before_.by_force) + recovered_.by_force,
                before.torque * (taken.by_torque - taken_before_.by_torque) + recovered_.by_torque};
  taken_before_ = taken;
  if (!std::isfinite(passed.all())) passed = taken_ = taken_before_ = {};
  passivity_.observe(joined(device.position, Vec3::Zero()), held.moved, passed.by_force);
  torque_passivity_.observe(joined(device.position, kTurnArm * turned_), held.all, passed.all());
  trust_ = trust;
  const Gains now = gains();
  recovered_ = {(now.force - before.force) * held.moved.scaled,
                (now.torque - before.torque) * held.all.scaled};
}

HapticLoop::Gains HapticLoop::gains() const {
  const double force = passivity_.gain(), torque = torque_passivity_.gain();
  return {trust_ * force, trust_ * std::min(force, torque)};
}

/// Wrench of the newest snapshot. Its difference to that of the last one fades, so there is no step.
Wrench HapticLoop::handedOver(const DeviceSample& device, const ProbeSnapshot& snapshot, const Wrench& wrench,
                              double now) {
  const auto remaining = [&] {
    const double passed = now - handover_start_;
    return handover_time_ > 0.0 ? std::clamp(1.0 - passed / handover_time_, 0.0, 1.0) : 0.0;
  };
  if (snapshot.taken != snapshot_.taken) {
    const bool both =
        snapshot_.taken >= 0.0 && snapshot_.contact && isFinite(snapshot_) && !hasJumped(device, snapshot_);
    Wrench before = wrench;
    if (both) {
      before = couplingWrench(options_, device, snapshot_);
      before.force += remaining() * handover_.force;
      before.torque += remaining() * handover_.torque;
    }
    handover_ = {limited(before.force - wrench.force, options_.max_force),
                 limited(before.torque - wrench.torque, options_.max_torque)};
    handover_time_ =
        std::clamp(kHandoverShare * (snapshot.taken - snapshot_.taken), kMinHandover, kMaxHandover);
    handover_start_ = now - 1.0 / options_.rate;  // the first step of it is this tick's
  }
  return {wrench.force + remaining() * handover_.force, wrench.torque + remaining() * handover_.torque};
}

}  // namespace haptic_cloth
