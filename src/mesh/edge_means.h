/// Means over the edges at each node.
#pragma once

#include <algorithm>
#include <vector>

#include "mesh/active_mesh.h"

namespace haptic_cloth {

/// Mean of a value over the edges of one direction at each node; 0 where there is none.
class EdgeMeans {
 public:
  /// @param capacity largest number of nodes
  explicit EdgeMeans(int capacity) { edges_.reserve(capacity); }

  /// @param value called with the number of an edge  @param means by node
  template <class Value>
  void compute(const ActiveMesh& mesh, int direction, Value value, std::vector<double>& means) {
    means.assign(mesh.nodes(), 0.0);
    edges_.assign(mesh.nodes(), 0);
    for (int e = 0; e < static_cast<int>(mesh.edges.size()); ++e) {
      const Edge& edge = mesh.edges[e];
      if (edge.direction != direction) continue;
      const double of_edge = value(e);
      for (const int n : {edge.a, edge.b}) {
        means[n] += of_edge;
        ++edges_[n];
      }
    }
    for (int n = 0; n < mesh.nodes(); ++n) means[n] /= std::max(1, edges_[n]);
  }

 private:
  std::vector<int> edges_;  ///< edges at each node, scratch
};

}  // namespace haptic_cloth
