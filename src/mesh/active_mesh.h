/// Active mesh: nodes, hanging nodes and elements of the leaf cells, numbered compactly.
#pragma once

#include <array>
#include <utility>
#include <vector>

#include "haptic_cloth/types.h"
#include "mesh/field.h"
#include "mesh/leaf_mesh.h"

namespace haptic_cloth {

/// Stretch element between two neighbours on a thread. Every leaf gives half of its width to each
/// of its sides.
struct Edge {
  int a, b;       ///< nodes
  int direction;  ///< kWarp or kWeft
  double length;  ///< rest length [m]
  double width;   ///< [m]
};

/// Bending element of three nodes in a row on a thread. Its curvature is κ = n · bent(x) with the
/// surface normal n at c.
struct Triple {
  int l, c, r;    ///< nodes
  int direction;  ///< kWarp or kWeft
  /// Coefficients 2/(l1+l2)/l1 and 2/(l1+l2)/l2 over the share 1 - α β of subtractSagitta() [1/m²]; a rigid
  /// arm counts as 0 in l1+l2.
  double left, right;
  double area;    ///< width times (l1+l2)/2 times that share [m²]
  double length;  ///< of two equal arms; of others √((l1+l2)/2 √(l1 l2)) [m]
  /// An arm that ends on a hanging node ends on the chord of a coarse side, which is off the surface
  /// by a sagitta. Nodes a and b beside c, across the thread, measure it. Coefficient [1/m²]; 0 and
  /// a = b = c if no arm ends so.
  double sagitta;
  int a, b;

  /// left (x_l - x_c) + right (x_r - x_c) - sagitta (x_a - 2 x_c + x_b) [1/m]. @param x positions of the
  /// nodes [m], or their change
  Vec3 bent(const Field& x) const {
    const Vec3 centre = x[c];
    return left * (x[l] - centre) + right * (x[r] - centre) - sagitta * ((x[a] - centre) + (x[b] - centre));
  }

  double centre() const { return 2.0 * sagitta - (left + right); }  ///< coefficient of x_c in bent()

  /// Nodes and their coefficients in bent(); those of a and b are zero where no sagitta counts.
  std::array<std::pair<int, double>, 5> parts() const {
    return {{{r, right}, {c, centre()}, {l, left}, {a, -sagitta}, {b, -sagitta}}};
  }
};

/// Leaf cell: shear element and patch of the surface.
struct Patch {
  std::array<int, 4> nodes;  ///< (i,j), (i+s,j), (i,j+s), (i+s,j+s)
  Cell cell;
  double area;               ///< rest area [m²]
  std::array<int, 4> sides;  ///< edges below and above (warp), left and right (weft)
};

/// Values at the corners of a leaf.
inline std::array<Vec3, 4> corners(const Patch& patch, const Field& x) {
  const auto& n = patch.nodes;
  return {x[n[0]], x[n[1]], x[n[2]], x[n[3]]};
}

/// Hanging node: the mean of two masters, which may hang on a coarser side.
struct Ghost {
  int node, a, b;
};

/// Lists of nodes (in the order free, pinned, hanging) and elements. They are rebuilt completely
/// after a change of the leaves. Vectors keep the capacity of the finest mesh, so that a run
/// allocates nothing.
class ActiveMesh {
 public:
  /// @param areal_density [kg/m²]
  ActiveMesh(const LeafMesh& leaves, double areal_density);

  void rebuild(const LeafMesh& leaves);

  int nodes() const { return static_cast<int>(particle.size()); }
  int active() const { return free + pinned; }

  Grid grid;
  int free = 0;               ///< nodes 0 .. free-1, the unknowns
  int pinned = 0;             ///< nodes free .. free+pinned-1, which stay
  std::vector<int> particle;  ///< finest-grid index of each node
  std::vector<int> node;      ///< node of each finest-grid particle, -1: none
  std::vector<double> mass;   ///< mass of each node [kg]; hanging nodes have none
  /// Hanging nodes, coarse sides first: masters before their dependents.
  std::vector<Ghost> ghosts;
  std::vector<Edge> edges;      ///< warp first, each direction in the order of its nodes a
  std::vector<Triple> triples;  ///< warp first, each direction in the order of its centres
  std::vector<Patch> patches;
  /// Patch corners in packs; unused lanes refer to node 0.
  std::vector<PatchCorners> patch_corners;

  /// Sets each hanging node to the mean of its masters.
  void interpolateGhosts(Field& values) const {
    for (int c = 0; c < 3; ++c) {
      auto& v = values.coordinate(c);
      for (const Ghost& g : ghosts) v[g.node] = 0.5 * (v[g.a] + v[g.b]);
    }
  }

  /// Marks the masters of marked hanging nodes. @param flags one for each node
  void markMasters(std::vector<char>& flags) const {
    for (auto g = ghosts.rbegin(); g != ghosts.rend(); ++g) {
      if (flags[g->node] != 0) flags[g->a] = flags[g->b] = 1;
    }
  }

  /// Transpose of interpolateGhosts(): adds share times each hanging node's entry to both masters.
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
  void subtractSagitta(Triple& triple, int arm) const;

  double areal_density_;
  std::vector<Cell> cells_;
  std::vector<char> role_;  ///< role of each particle: inactive, corner, hanging
  /// Widths and edges of the sides of all levels, by direction. Widths are in finest spacings; they
  /// are multiples of ½, which a float represents exactly.
  std::array<std::vector<float>, 2> side_width_;
  std::array<std::vector<int>, 2> side_edge_;
  std::vector<int> level_offset_;  ///< first side slot of each level
};

}  // namespace haptic_cloth
