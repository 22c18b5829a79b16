/// Fabric in the form that the solver uses: SI units, one law for each deformation.
#pragma once

#include <array>
#include <optional>
#include <string>
#include <vector>

#include "haptic_cloth/loop.h"

namespace haptic_cloth {

/// Compression of one layer by pressure on its faces, from KES-FB3 (docs/reference/fabrics.md).
struct Compression {
  double thickness = 0.0;          ///< T0: thickness where the pressure begins [m]
  double pressed_thickness = 0.0;  ///< Tm: thickness at 50 gf/cm², less than T0 [m]
  double linearity = 0.0;          ///< LC, between 0 and 1 [-]
};

/// Measured data of one fabric. Arrays are indexed by Direction (warp, weft).
struct Fabric {
  std::string name;
  std::string source;                      ///< publication or laboratory of the numbers
  std::vector<std::string> assumed;        ///< groups that were not measured for this fabric ("shear", ...)
  double areal_density = 0.0;              ///< [kg/m²]
  double thickness = 0.0;                  ///< [m]
  std::optional<Compression> compression;  ///< empty: not measured
  /// Stiffness below zero strain / slope at 1 % strain [-]. The loaders build it into `tensile`; a law that
  /// is given in code resists compression as it says itself.
  double compression_ratio = 0.1;
  std::array<Loop, 2> tensile;  ///< strain [-] → tension [N/m]
  std::array<Loop, 2> bending;  ///< curvature [1/m] → moment per width [N·m/m]
  /// B_t, from the bending rigidity on the bias; 0: no twist term [N·m]
  double twist_rigidity = 0.0;
  Loop shear;  ///< shear angle [rad] → shear force per width [N/m]
};

/// Reads a fabric file (docs/reference/fabrics.md; KES quantities in KES units).
/// @throws InputError for unreadable files, unknown keys, wrong types and impossible values.
Fabric loadFabric(const std::string& file);

/// Reads a fabric from YAML text.
/// @param origin name of the source in messages
/// @param name name of the fabric if the text has none
/// @throws InputError as loadFabric()
Fabric parseFabric(const std::string& yaml, const std::string& origin, const std::string& name);

/// Finds a fabric by name or path. A value that ends in ".yaml" is a path, relative to
/// `base_directory`. Otherwise NAME.yaml is looked up in $HAPTIC_CLOTH_FABRIC_PATH (colon
/// separated), in base_directory/../fabrics and in the fabrics shipped with the package.
/// @return path of the file; empty if there is none
std::string findFabric(const std::string& name_or_path, const std::string& base_directory);

}  // namespace haptic_cloth
