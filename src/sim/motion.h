/// Energy of motion and gravity of the nodes of one step, over lanes.
#pragma once

#include "mesh/field.h"

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

/// Writes the gradient at nodes begin..end at x. @return their energy [J]
double evaluateMotion(const Motion& motion, int begin, int end, const ConstArrays& x,
                      const MutableArrays& gradient);

/// d · H d of nodes begin..end.
double motionCurvature(const Motion& motion, int begin, int end, const ConstArrays& d);

}  // namespace haptic_cloth
