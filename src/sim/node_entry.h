/// Entries of a free node in a vector of all x of the free nodes, all y, all z, and more.
#pragma once

#include "haptic_cloth/types.h"
#include "solver/objective.h"

namespace haptic_cloth {

/// @param free number of free nodes
inline Vec3 entryOf(const Vector& vector, int free, int node) {
  return {vector[node], vector[free + node], vector[2 * free + node]};
}

/// @param free number of free nodes
inline void addEntry(Vector& vector, int free, int node, const Vec3& change) {
  for (int c = 0; c < 3; ++c) vector[c * free + node] += change[c];
}

}  // namespace haptic_cloth
