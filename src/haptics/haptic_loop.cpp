#include <algorithm>
#include <cmath>

#include "haptic_cloth/error.h"
#include "haptic_cloth/haptics.h"

namespace haptic_cloth {
namespace {

/// Farther ahead than this a proxy's velocity says nothing of where it is [s].
constexpr double kMaxPrediction = 0.02;

/// A late tick may catch up no more of the rate limit than this many ticks' worth, so a stall is not felt as
/// a jump.
constexpr double kMaxLateTicks = 5.0;

bool isFinite(const DeviceSample& sample) {
  return std::isfinite(sample.received) && sample.position.allFinite() && sample.velocity.allFinite();
}

bool isFinite(const ProbeSnapshot& snapshot) {
  return std::isfinite(snapshot.taken) && snapshot.proxy.allFinite() && snapshot.proxy_velocity.allFinite();
}

HapticStatus judge(const HapticOptions& options, const DeviceSample& device, const ProbeSnapshot& snapshot,
                   bool paused, double now) {
  if (paused) return HapticStatus::Paused;
  if (!isFinite(device) || device.received < 0.0) return HapticStatus::NoPose;
  if (!(now - device.received <= options.pose_timeout)) return HapticStatus::PoseStale;
  if (!isFinite(snapshot) || snapshot.taken < 0.0) return HapticStatus::NoSnapshot;
  if (!(now - snapshot.taken <= options.snapshot_timeout)) return HapticStatus::SnapshotStale;
  return snapshot.contact ? HapticStatus::Contact : HapticStatus::Free;
}

/// The virtual coupling [N], with the proxy carried on to `now`.
Vec3 couplingForce(const HapticOptions& options, const DeviceSample& device, const ProbeSnapshot& snapshot,
                   double now) {
  const double age = std::clamp(now - snapshot.taken, 0.0, kMaxPrediction);
  const Vec3 proxy = snapshot.proxy + age * snapshot.proxy_velocity;
  return options.coupling_stiffness * (proxy - device.position) +
         options.coupling_damping * (snapshot.proxy_velocity - device.velocity);
}

/// `force` shortened to `limit` [N], its direction kept. Zero if it is not finite.
Vec3 limited(const Vec3& force, double limit) {
  const double norm = force.norm();
  if (!std::isfinite(norm)) return Vec3::Zero();
  return norm > limit ? Vec3(force * (limit / norm)) : force;
}

/// One step of at most `step` [N] from `from` towards `to`; arrives exactly.
Vec3 approach(const Vec3& from, const Vec3& to, double step) {
  const Vec3 change = to - from;
  const double norm = change.norm();
  return norm > step ? Vec3(from + change * (step / norm)) : to;
}

}  // namespace

void validateHapticOptions(const HapticOptions& options, const std::string& origin) {
  const auto require = [&](const char* key, double value, bool zero_is_good) {
    const bool good = std::isfinite(value) && (zero_is_good ? value >= 0.0 : value > 0.0);
    if (good) return;
    throw InputError(origin, key, std::to_string(value),
                     zero_is_good ? "must be finite and >= 0" : "must be finite and > 0");
  };
  require("haptics/rate", options.rate, false);
  require("haptics/max_force", options.max_force, false);
  require("haptics/max_force_rate", options.max_force_rate, false);
  require("haptics/soft_start", options.soft_start, true);
  require("haptics/pose_timeout", options.pose_timeout, false);
  require("haptics/snapshot_timeout", options.snapshot_timeout, false);
  require("haptics/ramp_time", options.ramp_time, false);
  require("probe.coupling_stiffness", options.coupling_stiffness, true);
  require("probe.coupling_damping", options.coupling_damping, true);
}

const char* toString(HapticStatus status) {
  switch (status) {
    case HapticStatus::NoPose:
      return "no pose";
    case HapticStatus::NoSnapshot:
      return "no snapshot";
    case HapticStatus::PoseStale:
      return "pose stale";
    case HapticStatus::SnapshotStale:
      return "snapshot stale";
    case HapticStatus::Paused:
      return "paused";
    case HapticStatus::Free:
      return "free";
    case HapticStatus::Contact:
      return "contact";
  }
  return "unknown";
}

HapticLoop::HapticLoop(const HapticOptions& options) : options_(options) {
  validateHapticOptions(options, "haptic options");
}

Vec3 HapticLoop::tick(const DeviceSample& device, const ProbeSnapshot& snapshot, bool paused, double now) {
  const double period = 1.0 / options_.rate;
  double elapsed = period;
  if (last_tick_ >= 0.0 && std::isfinite(now)) {
    elapsed = std::clamp(now - last_tick_, 0.0, kMaxLateTicks * period);
  }
  if (std::isfinite(now)) last_tick_ = now;

  status_ = judge(options_, device, snapshot, paused, now);
  const bool good = status_ == HapticStatus::Free || status_ == HapticStatus::Contact;

  // A fault starts the soft start anew; its limit holds for the target only, the way down is the ramp's.
  soft_ = !good                       ? 0.0
          : options_.soft_start > 0.0 ? std::min(1.0, soft_ + elapsed / options_.soft_start)
                                      : 1.0;

  Vec3 target = Vec3::Zero();
  double rate = options_.max_force_rate;
  if (status_ == HapticStatus::Contact) {
    target = limited(couplingForce(options_, device, snapshot, now), soft_ * options_.max_force);
  } else if (!good) {
    rate = std::min(rate, options_.max_force / options_.ramp_time);
  }
  force_ = approach(force_, target, rate * elapsed);
  return force_;
}

}  // namespace haptic_cloth
