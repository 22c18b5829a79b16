/// Energy of motion and gravity of the nodes in one step, in SIMD lanes.
#pragma once

#include "simd/pack.h"

namespace haptic_cloth {

/// Inputs of the kernels; arrays are padded to whole lanes.
struct Motion {
  const double* mass;         ///< of all nodes [kg]
  const double* moving_mass;  ///< mass of free nodes, zero for the others [kg]
  double gravity[3];          ///< [m/s²]
  double inertia;             ///< (1 + c h)/h² [1/s²]
  ConstArrays start;          ///< x⁰ [m]
  ConstArrays inertial;       ///< position that inertia alone leads to [m]
};

// Kernels: evaluateMotion writes the gradient of nodes begin..end at x and returns their energy
// [J]; motionCurvature returns the quadratic form d · H d of these nodes.

}  // namespace haptic_cloth
