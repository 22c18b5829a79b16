/// Energy of motion and gravity of the nodes in one step, in SIMD lanes.
#pragma once

#include "simd/pack.h"

namespace haptic_cloth {

/// Inputs of the kernels; arrays are padded to whole lanes.
struct Motion {
  const double* mass;  ///< of all nodes [kg]
  /// For free nodes mass times their own inertia over `inertia`, zero for the others [kg].
  const double* moving_mass;
  double gravity[3];     ///< [m/s²]
  double inertia;        ///< TimeIntegrator::inertia() [1/s²]
  ConstArrays start;     ///< x⁰ [m]
  ConstArrays inertial;  ///< position to which inertia alone carries a node [m]
};

// Kernels: evaluateMotion writes the gradient of nodes begin..end at x and returns their energy
// [J]; motionQuadraticForm returns the quadratic form d · H d of these nodes.

}  // namespace haptic_cloth
