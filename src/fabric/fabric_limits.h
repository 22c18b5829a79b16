/// Limits of a fabric's numbers, in files and in code. No fabric reaches the first three, but a number in a
/// neighbouring unit does.
#pragma once

namespace haptic_cloth {

constexpr double kHeaviest = 10.0;        ///< [kg/m²]; fabrics have 0.01 to 5, in g/m² 10 and more
constexpr double kThickest = 0.05;        ///< [m]; fabrics have 1e-4 to 1e-2, in mm 0.1 and more
constexpr double kAlike = 10.0;           ///< largest ratio of T0 and the fabric's thickness
constexpr double kMostPressed = 0.99;     ///< largest Tm/T0; mesh changes of steeper laws make energy
constexpr double kLeastLinearity = 0.05;  ///< of compression; below 1

constexpr const char* kHeaviestRule = "must be at most 10: it is in kg/m^2, not g/m^2";
constexpr const char* kThickestRule = "must be at most 0.05: it is in m, not mm";

}  // namespace haptic_cloth
