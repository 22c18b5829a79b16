/// What takes part in the solve: nodes, ghosts and elements of the leaf cells, numbered compactly.
#pragma once

#include <array>
#include <vector>

#include "haptic_cloth/types.h"
#include "mesh/field.h"
#include "mesh/leaf_mesh.h"

namespace haptic_cloth {

/// Stretch element between two neighbours on a thread. Every leaf gives half of its width to each of its
/// sides.
struct Edge {
  int a, b;       ///< nodes
  int direction;  ///< kWarp or kWeft
  double length;  ///< at rest [m]
  double width;   ///< [m]
};

/// Bending element of three nodes in a row on a thread. Curvature is
/// κ = n · (left (x_l - x_c) + right (x_r - x_c)), n the surface normal at c.
struct Triple {
  int l, c, r;         ///< nodes
  int direction;       ///< kWarp or kWeft
  double left, right;  ///< coefficients 2/(l1+l2)/l1 and 2/(l1+l2)/l2 [1/m²]
  double area;         ///< width times (l1+l2)/2 [m²]
};

/// A leaf cell: shear element and patch of surface.
struct Patch {
  std::array<int, 4> nodes;  ///< (i,j), (i+s,j), (i,j+s), (i+s,j+s)
  Cell cell;
  double area;               ///< at rest [m²]
  std::array<int, 4> sides;  ///< edges below and above (warp), left and right (weft)
};

/// Values at a leaf's corners.
inline std::array<Vec3, 4> corners(const Patch& patch, const Field& x) {
  const auto& n = patch.nodes;
  return {x[n[0]], x[n[1]], x[n[2]], x[n[3]]};
}

/// A hanging corner: the mean of two masters, which may be ghosts of a coarser side.
struct Ghost {
  int node, a, b;
};

/// Lists over nodes in the order free, pinned, ghost. Rebuilt as a whole after a change of the leaves;
/// vectors keep the capacity of the finest mesh, so that nothing is allocated in a run.
class ActiveMesh {
 public:
  /// @param areal_density [kg/m²]
  ActiveMesh(const LeafMesh& leaves, double areal_density);

  void rebuild(const LeafMesh& leaves);

  int nodes() const { return static_cast<int>(particle.size()); }
  int active() const { return free + pinned; }

  Grid grid;
  int free = 0;                 ///< nodes 0 .. free-1 are the unknowns
  int pinned = 0;               ///< nodes free .. free+pinned-1 are held
  std::vector<int> particle;    ///< finest-grid index of a node
  std::vector<int> node;        ///< node of a finest-grid particle, -1: not in the mesh
  std::vector<double> mass;     ///< of a node, ghosts' handed to their masters [kg]
  std::vector<Ghost> ghosts;    ///< coarse sides first: masters come before their ghosts
  std::vector<Edge> edges;      ///< warp first, each direction in the order of its nodes a
  std::vector<Triple> triples;  ///< warp first, each direction in the order of its centres
  std::vector<Patch> patches;
  std::vector<PatchCorners> patch_corners;  ///< of a pack of patches each; past the last, node 0

  /// Replaces each ghost's entry by the mean of its masters'.
  void interpolateGhosts(Field& values) const {
    for (int c = 0; c < 3; ++c) {
      auto& v = values.coordinate(c);
      for (const Ghost& g : ghosts) v[g.node] = 0.5 * (v[g.a] + v[g.b]);
    }
  }

  /// Transpose of interpolateGhosts: adds share times each ghost's entry to both masters.
  template <class Values>
  void handOverGhosts(Values& values, double share = 0.5) const {
    for (auto g = ghosts.rbegin(); g != ghosts.rend(); ++g) {
      values[g->a] += share * values[g->node];
      values[g->b] += share * values[g->node];
    }
  }
  void handOverGhosts(Field& values, double share = 0.5) const {
    for (int c = 0; c < 3; ++c) handOverGhosts(values.coordinate(c), share);
  }

 private:
  void numberNodes(const LeafMesh& leaves);
  void findGhosts();
  void listPatches();
  void lumpMass();
  void buildEdges();
  void numberEdges(int direction);
  int sideSlot(int level, int i, int j) const;
  void buildTriples(const LeafMesh& leaves);
  void addTriple(const LeafMesh& leaves, int centre, int direction);

  double areal_density_;
  std::vector<Cell> cells_;
  std::vector<char> role_;  ///< of a particle: not in the mesh, corner, ghost
  /// By direction; slots of all levels; halves of finest spacings, so a float holds them.
  std::array<std::vector<float>, 2> side_width_;
  std::array<std::vector<int>, 2> side_edge_;
  std::vector<int> level_offset_;  ///< first side slot of a level
};

}  // namespace haptic_cloth
