/// The virtual coupling's force for poses that are newer than the solver's.
#pragma once

#include "haptic_cloth/haptics.h"

namespace haptic_cloth {

/// Force of the coupling [N] for any pose, by one snapshot: the proxy follows what the device has moved
/// since, by the solver's measure, and what it did beside that in the solved step goes on for a while.
Vec3 couplingForce(const HapticOptions& options, const DeviceSample& device, const ProbeSnapshot& snapshot);

/// couplingForce() with its torque about the probe's origin. The change of the force since the
/// solve acts at the lever arm of the solve's force and torque. It changes the torque by no more than
/// the torque's size at the solve.
Wrench couplingWrench(const HapticOptions& options, const DeviceSample& device,
                      const ProbeSnapshot& snapshot);

/// Most energy that coupling and cloth give back when they relax from here: together a few times the energy
/// of a spring of the local stiffness k (1 - follow).
HeldEnergy heldEnergy(const HapticOptions& options, const DeviceSample& device,
                      const ProbeSnapshot& snapshot);

}  // namespace haptic_cloth
