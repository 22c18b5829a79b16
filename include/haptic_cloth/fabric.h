/// A fabric as the solver uses it: SI units, one law per deformation.
#pragma once

#include <array>
#include <string>
#include <vector>

#include "haptic_cloth/loop.h"

namespace haptic_cloth {

/// Measured data of one fabric. Arrays are indexed by Direction (warp, weft).
struct Fabric {
  std::string name;
  std::string source;                ///< where the numbers come from
  std::vector<std::string> assumed;  ///< groups that were not measured for this fabric ("shear", ...)
  double areal_density = 0.0;        ///< [kg/m²]
  double thickness = 0.0;            ///< [m]
  double compression_ratio = 0.1;    ///< stiffness below zero strain over the tangent one at 1 % strain [-]
  std::array<Loop, 2> tensile;       ///< strain [-] → tension [N/m]
  std::array<Loop, 2> bending;       ///< curvature [1/m] → moment per width [N·m/m]
  double twist_rigidity = 0.0;       ///< B_t, from the bending rigidity on the bias; 0: no twist term [N·m]
  Loop shear;                        ///< shear angle [rad] → shear force per width [N/m]
};

/// Reads a fabric file (format: docs/reference/fabrics.md; KES units where KES has them).
/// @throws InputError for unreadable files, unknown keys, wrong types and impossible values.
Fabric loadFabric(const std::string& file);

/// Reads a fabric from YAML text. @param origin names the source in messages; @param name is the fabric's
/// where the text has none.
/// @throws InputError as loadFabric()
Fabric parseFabric(const std::string& yaml, const std::string& origin, const std::string& name);

/// Finds a fabric by name or path. A value that ends in ".yaml" is a path, relative to `base_directory`;
/// else NAME.yaml is looked up in $HAPTIC_CLOTH_FABRIC_PATH (colon separated), in base_directory/../fabrics
/// and in the fabrics shipped with the package.
/// @return the file's path; empty if there is none
std::string findFabric(const std::string& name_or_path, const std::string& base_directory);

}  // namespace haptic_cloth
