/// What the physics tests measured, for docs/validation.md.
#pragma once

#include <string>

namespace haptic_cloth {

/// One number beside its reference.
struct Measured {
  std::string test_case;  ///< name of the case, the same for all its records: one row of the table
  std::string quantity;   ///< what was measured, with unit
  std::string mesh;       ///< finest, amrc, coarsest, ...
  double at;              ///< parameter of the case (λ, N, angle, ...); 0 where it has none
  double value, exact;    ///< in the unit of the quantity
  double scale;           ///< what the error is relative to, same unit
};

/// Prints the error; appends a line to the CSV file $HAPTIC_CLOTH_RECORD where that is set
/// (scripts/validation.py draws the table and the plots from it).
void record(const Measured& measured);

}  // namespace haptic_cloth
