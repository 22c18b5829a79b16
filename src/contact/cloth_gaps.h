/// Distances of the cloth from one solid.
#pragma once

#include <vector>

#include "contact/solid.h"
#include "mesh/active_mesh.h"
#include "mesh/field.h"
#include "parallel/parallel_for.h"

namespace haptic_cloth {

/// Distances of points from a solid [m], and its normals there.
struct Distances {
  void reserve(int points);

  /// Measures the first `count` points.
  void measure(const Solid& solid, int count, const Field& points, Team& team);

  Distance operator[](int k) const { return {gaps[k], normals[k]}; }

  std::vector<double> gaps;
  Field normals;
};

/// Distances of the nodes from a solid, and the patches that may come near it.
class ClothGaps {
 public:
  explicit ClothGaps(const Grid& grid);

  /// @param solid has sharp edges: over rounded ones the normals at the nodes would not tell where an edge is
  /// @param range within which patches are near [m]
  /// @param reach largest expected motion of each node [m]
  void measure(const Solid& solid, double range, const ActiveMesh& mesh, const Field& nodes,
               const std::vector<double>& reach, Team& team);

  const Distances& nodes() const { return nodes_; }

  /// Gap below which points of a patch count, or -1 [m].
  double margin(int patch) const { return margins_[patch]; }

  /// Difference of the solid's normals at two corners of a patch [rad].
  double normalTurn(const Patch& patch, int c, int d) const;

 private:
  Distances nodes_;
  std::vector<double> margins_;
};

}  // namespace haptic_cloth
