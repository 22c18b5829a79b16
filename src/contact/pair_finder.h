/// Search for pairs of parts of the cloth that may meet in a step.
#pragma once

#include <array>
#include <vector>

#include "contact/cloth_tree.h"
#include "contact/pair_packs.h"
#include "mesh/active_mesh.h"
#include "mesh/field.h"
#include "mesh/triangle_surface.h"

namespace haptic_cloth {

/// The nodes of a pair of a node and a triangle, or of two lines.
inline std::array<int, 4> nodesOf(const PairPack& pack, int lane) {
  return {pack.nodes[0].index[lane], pack.nodes[1].index[lane], pack.nodes[2].index[lane],
          pack.nodes[3].index[lane]};
}

/// Finds pairs of a node and a triangle, and of two lines, that may touch within a step. Two surfaces
/// of triangles that do not cross can only begin to cross where such a pair meets. Nodes and triangles
/// carry the pressure between layers: each node presses with half of its area on the triangles near it
/// on either of its sides, and the other layer's nodes do the same. Where a probe may dent layers, so that
/// the pressure changes much within a cell, the middles of lines press like nodes. Lines are sides and
/// diagonals of leaves; as wholes they press only where nodes cannot: at folds and borders that cross each
/// other.
class PairFinder {
 public:
  /// Expected motion of the nodes in a step.
  struct Reach {
    const Field& motion;                   ///< displacement by their velocity, or in the last solve [m]
    const std::vector<double>& deviation;  ///< largest distance from it at the end [m]
  };

  /// @param thickness distance at which layers begin to press [m]
  PairFinder(const Grid& grid, double thickness);

  /// Must follow a change of the mesh.
  void rebuild(const ActiveMesh& mesh);

  /// Lists pairs in packs: those of points and triangles first.
  /// @param normals of the surface at the nodes
  /// @param dented see SampleFinder::dented()
  void find(const ActiveMesh& mesh, const Field& nodes, const ConstArrays& normals, const Reach& reach,
            const std::vector<char>& dented, std::vector<PairPack>& packs);

  /// Tells whether parts that are not in the list of the last find() may have met on the straight way
  /// from the start of the step to its end.
  /// @param deviates nodes have moved farther than their Reach allows
  bool mayMeetUnlisted(const ActiveMesh& mesh, const Field& start, const Field& end, bool deviates,
                       const std::vector<PairPack>& packs);

  /// Prepares hasRoom() for positions of the nodes [m].
  void beginChange(const ActiveMesh& mesh, const Field& nodes);

  /// Tells whether the surface may move by `moved` in a cell, and in its neighbours along with it,
  /// without coming nearer than `least` to another part that moves as little as its own room allows [m].
  bool hasRoom(const ActiveMesh& mesh, const Field& nodes, const Cell& cell, double moved, double least);

  /// Starts a step, in which all parts may count as smooth; see ClothTree::staysSmooth().
  void forgetRough() { tree_.forgetRough(); }

 private:
  struct Candidate {
    std::array<int, 4> nodes;
    double range;     ///< [m]
    double distance;  ///< at the start of the step [m]
    int side;         ///< of the point's surface: 0 below, 1 above
    int point;        ///< see areas_
    int other;        ///< last node of PairPoints
  };

  /// Triangles near a point on one of its sides.
  struct Group {
    int first, size;  ///< in sorted_
    double excess;    ///< distance of the nearest one minus its range at the start of the step [m]
  };

  void search(const ActiveMesh& mesh, const Field& nodes, const Reach& reach, double within,
              double lines_within, double spare = 0.0);
  bool isClear(const ActiveMesh& mesh, const Field& nodes, const Reach& reach);
  bool areSmooth(const ActiveMesh& mesh, const Field& nodes);
  bool becomesClear(const ActiveMesh& mesh, const Field& nodes, const Reach& reach);
  /// Distance from clear_at_ within which nothing meets [m].
  double clearance() const { return 0.1 * grid_.shortestSpacing(); }
  void addPatches(const ActiveMesh& mesh, const Field& nodes, const Reach& reach, int a, int b);
  void layPoints(const ActiveMesh& mesh, const std::vector<char>& dented);
  void layMiddle(int line, double area);
  void addPoint(const ActiveMesh& mesh, const Field& nodes, const Reach& reach, int point,
                const TriangleSurface::Line& ends, const TriangleSurface::Triangle& triangle);
  void addLines(const ActiveMesh& mesh, const Field& nodes, const Reach& reach,
                const TriangleSurface::Line& a, const TriangleSurface::Line& b);
  Eigen::Vector2d inFlatCloth(const ActiveMesh& mesh, int node) const;
  double rangeOf(const std::array<Eigen::Vector2d, 4>& p, bool lines) const;
  static void put(PairPack& pack, int lane, const Candidate& pair, double area);
  void sortByPoint();
  void findGroups();
  void listGroups(std::vector<PairPack>& packs);
  void listLines(std::vector<PairPack>& packs) const;

  Grid grid_;
  double thickness_;
  TriangleSurface surface_;
  ClothTree tree_;
  std::vector<double> margins_;               ///< of the boxes at the nodes [m]
  double within_ = 0.0, lines_within_ = 0.0;  ///< distances of the pairs that are searched [m]
  ConstArrays normals_{};                     ///< during find()
  std::vector<double> areas_;   ///< of the cloth that points stand for: nodes, then middles of lines [m²]
  std::vector<int> middle_of_;  ///< point in the middle of each line, or -1; empty but during find()
  std::vector<Candidate> points_, lines_, sorted_;
  std::vector<Group> groups_;
  double most_ = 0.0;   ///< bound of the motion of the patches in addPatches() relative to each other [m]
  bool clear_ = false;  ///< no pair is near while all nodes stay near clear_at_
  Field clear_at_;      ///< [m]
  Field smooth_at_;     ///< the last positions at which the spare of smooth parts was measured [m]
  double spare_ = 0.0;  ///< that spare [-]
  int wait_ = 0;        ///< number of searches until clear_ is tried again
  Field motion_;        ///< scratch of other searches than that of find(), as the next two
  std::vector<double> deviation_;
  std::vector<std::array<int, 4>> listed_;
  std::vector<int> rows_;  ///< sorted_ of point n: rows_[n] .. rows_[n + 1]
};

}  // namespace haptic_cloth
