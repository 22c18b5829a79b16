#include "haptics/coupling_model.h"

#include <algorithm>
#include <cmath>

#include "haptics/limits.h"

namespace haptic_cloth {
namespace {

/// Time in which the drift of the proxy fades: the motion of cloth that slides or swings [s]. Of 5, 10
/// and 20 ms this is the best on the measured strokes (decision 0015).
constexpr double kDriftMemory = 0.01;

/// Bound of the relaxing energy over what the local stiffness gives [-]: twice where force rises with
/// any power of length; the rest is for weight that was lifted and cloth in motion.
constexpr double kHeldShare = 4.0;

/// Local stiffness over that of the coupling if the proxy follows the device fully [-].
constexpr double kLeastHold = 0.05;

/// A force below this share of the largest says little about where it acts [-].
constexpr double kTellingForce = 0.05;

/// Change of the force since the solve, over the largest force, that a probe with cloth in its grasp always
/// shows [-].
constexpr double kFreeChange = 0.05;

struct ProxyNow {
  Vec3 position, velocity;
};

ProxyNow proxyFor(const DeviceSample& device, const ProbeSnapshot& snapshot) {
  const double age = std::max(0.0, device.received - snapshot.device_received);
  const double fade = std::exp(-age / kDriftMemory);
  const Vec3 moved = device.position - snapshot.device;
  // The damper's speeds are both the filtered ones: what the proxy shares with the device then cancels, noise
  // and lag of the filter included.
  return {snapshot.proxy + snapshot.follow * moved + kDriftMemory * (1.0 - fade) * snapshot.drift,
          snapshot.follow * device.velocity + fade * snapshot.drift};
}

}  // namespace

Vec3 couplingForce(const HapticOptions& options, const DeviceSample& device, const ProbeSnapshot& snapshot) {
  const ProxyNow proxy = proxyFor(device, snapshot);
  const Vec3 force = options.coupling_stiffness * (proxy.position - device.position) +
                     options.coupling_damping * (proxy.velocity - device.velocity);
  if (!snapshot.holds) return force;
  const Vec3 solved = options.coupling_stiffness * (snapshot.proxy - snapshot.device);
  return solved + limited(force - solved, std::max(solved.norm(), kFreeChange * options.max_force));
}

Wrench couplingWrench(const HapticOptions& options, const DeviceSample& device,
                      const ProbeSnapshot& snapshot) {
  const Vec3 force = couplingForce(options, device, snapshot);
  const double small = kTellingForce * options.max_force;
  const Vec3 arm = snapshot.force.cross(snapshot.torque) / (snapshot.force.squaredNorm() + small * small);
  const Vec3 change = arm.cross(force - snapshot.force);
  return {force, snapshot.torque + limited(change, snapshot.torque.norm())};
}

HeldEnergy heldEnergy(const HapticOptions& options, const DeviceSample& device,
                      const ProbeSnapshot& snapshot) {
  const Vec3 stretch = proxyFor(device, snapshot).position - device.position;
  const Mat3 hold = (1.0 + kLeastHold) * Mat3::Identity() - snapshot.follow;
  const double coupling = 0.5 * options.coupling_stiffness * stretch.squaredNorm();
  const double all = 0.5 * kHeldShare * options.coupling_stiffness * stretch.dot(hold.inverse() * stretch);
  return {coupling, all - coupling};
}

}  // namespace haptic_cloth
