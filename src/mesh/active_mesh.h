/// What takes part in the solve: nodes, ghosts and elements of the leaf cells, numbered compactly.
#pragma once

#include <array>
#include <vector>

#include "haptic_cloth/types.h"
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

/// A hanging corner: the mean of two masters, which may be ghosts of a coarser side.
struct Ghost {
  int node, a, b;
};

/// Row of a node in a gather list: rows[n] .. rows[n+1].
struct Incidence {
  int slot;            ///< where an element put its vector
  double coefficient;  ///< by which the node takes it
};

/// Lists over nodes in the order free, pinned, ghost. Rebuilt as a whole after a change of the leaves;
/// vectors keep the capacity of the finest mesh, so that nothing is allocated in a run.
class ActiveMesh {
 public:
  /// @param areal_density [kg/m²]  @param twist whether patches have a slot for a twist term
  ActiveMesh(const LeafMesh& leaves, double areal_density, bool twist = false);

  void rebuild(const LeafMesh& leaves);

  int nodes() const { return static_cast<int>(particle.size()); }
  int active() const { return free + pinned; }

  Grid grid;
  int free = 0;               ///< nodes 0 .. free-1 are the unknowns
  int pinned = 0;             ///< nodes free .. free+pinned-1 are held
  std::vector<int> particle;  ///< finest-grid index of a node
  std::vector<int> node;      ///< node of a finest-grid particle, -1: not in the mesh
  std::vector<double> mass;   ///< of a node, ghosts' handed to their masters [kg]
  std::vector<Ghost> ghosts;  ///< coarse sides first: masters come before their ghosts
  std::vector<Edge> edges;
  std::vector<Triple> triples;
  std::vector<Patch> patches;

  /// Gather lists: which element slots act on a node. Slots are numbered edges, triples, then two
  /// (with a twist term three) a patch.
  std::vector<int> rows;
  std::vector<Incidence> incidences;
  int slots_per_patch;
  int slots() const {
    return static_cast<int>(edges.size() + triples.size() + slots_per_patch * patches.size());
  }

  /// Replaces each ghost's entry by the mean of its masters'.
  template <class Values>
  void interpolateGhosts(Values& values) const {
    for (const Ghost& g : ghosts) values[g.node] = 0.5 * (values[g.a] + values[g.b]);
  }

  /// Transpose of interpolateGhosts: adds share times each ghost's entry to both masters.
  template <class Values>
  void handOverGhosts(Values& values, double share = 0.5) const {
    for (auto g = ghosts.rbegin(); g != ghosts.rend(); ++g) {
      values[g->a] += share * values[g->node];
      values[g->b] += share * values[g->node];
    }
  }

 private:
  void numberNodes(const LeafMesh& leaves);
  void findGhosts();
  void lumpMass();
  void buildEdges();
  int addSide(const Cell& cell, int i, int j, int direction);
  void buildTriples(const LeafMesh& leaves);
  void addTriple(const LeafMesh& leaves, int centre, int direction);
  void buildIncidences();

  double areal_density_;
  std::vector<Cell> cells_;
  std::vector<char> role_;                        ///< of a particle: not in the mesh, corner, ghost
  std::array<std::vector<int>, 2> edge_of_slot_;  ///< by direction; slots of all levels
  std::vector<int> level_offset_;                 ///< first edge slot of a level
};

}  // namespace haptic_cloth
