/// Energy of motion and gravity of the nodes of one step, over lanes.
#pragma once

#include "simd/pack.h"

namespace haptic_cloth {

/// What it depends on; arrays are padded to whole lanes.
struct Motion {
  const double* mass;         ///< of all nodes [kg]
  const double* moving_mass;  ///< of the free ones, zero for the others [kg]
  double gravity[3];          ///< [m/s²]
  double inertia;             ///< (1 + c h)/h² [1/s²]
  ConstArrays start;          ///< where the step starts [m]
  ConstArrays inertial;       ///< where inertia would lead [m]
};

// Kernels: evaluateMotion writes the gradient at nodes begin..end at x and returns their energy [J];
// motionCurvature returns d · H d of these nodes.

}  // namespace haptic_cloth
