#include "haptics/coupling_model.h"

#include <algorithm>
#include <cmath>

#include "haptics/limits.h"
#include "sim/turn_spring.h"

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

/// Spring and damper of the coupling. In all vectors, turns count times the radius at which it resists them.
struct Coupling {
  Vec6 stretch = Vec6::Zero();                     ///< force of the spring over its stiffness [m]
  double moved_energy = 0.0, turned_energy = 0.0;  ///< of the spring, over its stiffness [m²]
  Vec6 slip = Vec6::Zero();                        ///< velocity of the proxy less that of the device [m/s]
};

Coupling couplingAt(const DeviceSample& device, const ProbeSnapshot& snapshot) {
  const double age = std::max(0.0, device.received - snapshot.device_received);
  const double fade = std::exp(-age / kDriftMemory), radius = snapshot.turn_radius;
  const Vec6 moved = joined(device.position - snapshot.device,
                            radius * turnBetween(snapshot.device_orientation, device.orientation));
  const Vec6 velocity = joined(device.velocity, radius * device.angular_velocity);
  const Vec6 followed = snapshot.follow * moved + kDriftMemory * (1.0 - fade) * snapshot.drift;
  Coupling coupling;
  coupling.stretch.head<3>() = snapshot.proxy + followed.head<3>() - device.position;
  coupling.moved_energy = 0.5 * coupling.stretch.squaredNorm();
  if (radius > 0.0) {
    const Quat orientation = rotationBy(followed.tail<3>() / radius) * snapshot.proxy_orientation;
    const TurnSpring spring(orientation, device.orientation);
    coupling.stretch.tail<3>() = -radius * spring.torque();
    coupling.turned_energy = radius * radius * spring.energy();
  }
  // The damper's speeds are both the filtered ones: what the proxy shares with the device then cancels, noise
  // and lag of the filter included.
  coupling.slip = snapshot.follow * velocity + fade * snapshot.drift - velocity;
  return coupling;
}

/// Energy of a spring that pulls with at most `limit` [N], [J].
double energyOf(double stretch, double stiffness, double limit) {
  const double elastic = std::min(stretch, limit / stiffness);  // the part with less than the limit
  return 0.5 * stiffness * elastic * elastic + limit * (stretch - elastic);
}

}  // namespace

Wrench couplingWrench(const HapticOptions& options, const DeviceSample& device,
                      const ProbeSnapshot& snapshot) {
  const Coupling coupling = couplingAt(device, snapshot);
  const double radius = snapshot.turn_radius, stiffness = options.coupling_stiffness;
  const Vec6 all = stiffness * coupling.stretch + options.coupling_damping * coupling.slip;
  Wrench wrench{all.head<3>(), radius * all.tail<3>()};
  if (snapshot.holds) {
    const Vec3 solved = stiffness * (snapshot.proxy - snapshot.device);
    wrench.force =
        solved + limited(wrench.force - solved, std::max(solved.norm(), kFreeChange * options.max_force));
  }
  if (radius > 0.0) return wrench;
  const double small = kTellingForce * options.max_force;
  const Vec3 arm = snapshot.force.cross(snapshot.torque) / (snapshot.force.squaredNorm() + small * small);
  const Vec3 change = arm.cross(wrench.force - snapshot.force);
  return {wrench.force, snapshot.torque + limited(change, snapshot.torque.norm())};
}

double springEnergy(const HapticOptions& options, const DeviceSample& device, const ProbeSnapshot& snapshot,
                    double limit) {
  return energyOf(couplingAt(device, snapshot).stretch.head<3>().norm(), options.coupling_stiffness, limit);
}

HeldEnergies heldEnergies(const HapticOptions& options, const DeviceSample& device,
                          const ProbeSnapshot& snapshot, double limit) {
  const Coupling coupling = couplingAt(device, snapshot);
  const Mat6 hold = (1.0 + kLeastHold) * Mat6::Identity() - snapshot.follow;
  const Vec3 moved = coupling.stretch.head<3>();
  const double stiffness = options.coupling_stiffness, felt = energyOf(moved.norm(), stiffness, limit);
  const double turned = stiffness * coupling.turned_energy, spring = stiffness * coupling.moved_energy;
  const auto relaxed = [&](double squared) { return 0.5 * kHeldShare * stiffness * squared; };
  return {{felt, relaxed(moved.dot(hold.topLeftCorner<3, 3>().inverse() * moved)) - spring, felt},
          {felt + turned,
           relaxed(coupling.stretch.dot(hold.ldlt().solve(coupling.stretch))) - spring - turned, turned}};
}

}  // namespace haptic_cloth
