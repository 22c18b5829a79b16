/// Wrench and energy of the virtual coupling at poses that are newer than the solver's.
#pragma once

#include "haptic_cloth/haptics.h"

namespace haptic_cloth {

/// Force and torque of the coupling for any pose, from one snapshot. The proxy follows the motion of the
/// device since the snapshot by `follow`, and its own drift fades. If the probe holds cloth, the force
/// changes by no more than its size at the solve, or 5 % of max_force if that is more: cloth that hangs
/// from the hand gives too little force to tell how it answers a longer move.
///
/// A probe whose coupling does not turn it meets the change of the force since the solve at the lever arm
/// of the solve's force and torque. That changes the torque by no more than its size at the solve.
Wrench couplingWrench(const HapticOptions& options, const DeviceSample& device,
                      const ProbeSnapshot& snapshot);

struct HeldEnergies {
  HeldEnergy moved;  ///< by the motion of the device alone
  HeldEnergy all;    ///< by its motion and turns
};

/// Energy that the coupling's spring gives back to a device that moves, with a force within `limit` [N], [J].
double springEnergy(const HapticOptions& options, const DeviceSample& device, const ProbeSnapshot& snapshot,
                    double limit);

/// Largest energy that coupling and cloth can give back when they relax: together a few times the
/// energy of a spring of the local stiffness k (1 - follow).
/// @param limit of the force, which bounds what the coupling's spring gives back to motion [N]
HeldEnergies heldEnergies(const HapticOptions& options, const DeviceSample& device,
                          const ProbeSnapshot& snapshot, double limit);

}  // namespace haptic_cloth
