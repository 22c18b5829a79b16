/// Records of the physics tests, for docs/validation.md.
#pragma once

#include <string>

namespace haptic_cloth {

/// Measured number with its reference.
struct Measured {
  std::string test_case;  ///< name of the case, the same for all its records: one row of the table
  std::string quantity;   ///< name of the quantity, with unit
  std::string mesh;       ///< finest, amrc, coarsest, ...
  double at;              ///< parameter of the case (λ, N, angle, ...); 0 if it has none
  double value, exact;    ///< in the unit of the quantity
  double scale;           ///< reference of the error, same unit
};

/// Prints the error, and appends a line to the CSV file $HAPTIC_CLOTH_RECORD if that is set.
/// scripts/validation.py makes the table and the plots from that file.
void record(const Measured& measured);

}  // namespace haptic_cloth
