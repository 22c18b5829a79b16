#include "support/record.h"

#include <cstdlib>
#include <fstream>
#include <iostream>

namespace haptic_cloth {

void record(const Measured& m) {
  const double error = 100.0 * (m.value - m.exact) / m.scale;
  std::cout << "  " << m.test_case << ", " << m.quantity << ", " << m.mesh << ", at " << m.at << ": "
            << m.value << " (" << m.exact << "), error " << error << " %\n";
  const char* path = std::getenv("HAPTIC_CLOTH_RECORD");
  if (path == nullptr) return;
  std::ofstream file(path, std::ios::app);
  file.precision(9);
  file << '"' << m.test_case << "\",\"" << m.quantity << "\"," << m.mesh << ',' << m.at << ',' << m.value
       << ',' << m.exact << ',' << error << '\n';
}

}  // namespace haptic_cloth
