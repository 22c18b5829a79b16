/// Solid in the format of the kernels.
#pragma once

#include "haptic_cloth/scene.h"

namespace haptic_cloth {

struct SolidLanes {
  Shape shape;
  double half_size[3], radius, half_length;  ///< [m]
  double edge_radius;                        ///< by which sharp edges are rounded [m]
  double position[3], rotation[9];           ///< rotation by rows: local to world
};

}  // namespace haptic_cloth
