/// Search for contact samples at the start of a step.
#pragma once

#include <algorithm>
#include <array>
#include <optional>
#include <vector>

#include "contact/contact_law.h"
#include "contact/friction_memory.h"
#include "contact/sample_list.h"
#include "contact/solid_set.h"
#include "mesh/active_mesh.h"
#include "mesh/field.h"
#include "parallel/parallel_for.h"

namespace haptic_cloth {

/// Finds samples. Obstacles are sampled at the nodes, and at every point of the finest grid in
/// coarse cells on which they do not press evenly, so that these rest like fine ones. Across sharp
/// edges samples lie closer together. Those of a probe are at most a third of its radius apart, and of the
/// radius on which it presses on flat cloth. Model: decisions 0010 and 0041.
class SampleFinder {
 public:
  /// Reach of a probe in the next step.
  struct Reach {
    int probe;
    double distance;  ///< largest expected motion of its proxy [m]
  };

  SampleFinder(const Grid& grid, const SolidSet& solids, const ContactLaw& law, const FrictionMemory& memory,
               Team& team);

  /// Number of samples to reserve memory for. If finest cells outside dents have at most one sample of each
  /// solid, cells two finest cells wide under an uneven solid need most: five samples and one node for four
  /// finest cells. Otherwise the number comes from experience with scenes; a step that needs more
  /// allocates.
  int capacity() const;

  /// Saves or loads what is let out of obstacles.
  void serialize(Archive& archive);

  /// Finds the samples of probes that may touch within a step, and freezes their friction. The parameters
  /// are those of ContactSet::collectProbes().
  void findProbes(const ActiveMesh& mesh, const Field& nodes, const std::vector<double>& reach,
                  const Field& motion, const std::vector<Reach>& touching, SampleList& samples);

  /// The same for obstacles. @pre findProbes()
  void findObstacles(const ActiveMesh& mesh, const Field& nodes, const std::vector<double>& reach,
                     const Field& motion, SampleList& samples);

  /// Flags of the patches where a probe that touches at the start of the step may dent flat layers that press
  /// on each other. @pre findProbes()
  const std::vector<char>& dented() const { return dented_; }

  /// Direction in which the probe becomes clear of the cloth soonest: that of the force of springs at all
  /// points of the cloth within the range of contact. Empty if there are none.  @pre SolidSet::startProbe()
  std::optional<Vec3> wayOut(const ActiveMesh& mesh, const Field& nodes, int probe);

 private:
  /// Distances of points from a solid [m], and its normals there.
  struct Distances {
    std::vector<double> gaps;
    Field normals;
    Distance operator[](int k) const { return {gaps[k], normals[k]}; }
  };

  /// How a solid moves in the step.
  struct SolidStep {
    bool still;
    Eigen::AngleAxisd turn;
    Mat3 rotation;  ///< by that turn
  };

  /// Ball around all nodes and as far as they may move [m].
  struct Ball {
    Vec3 centre;
    double radius;
  };
  static Ball ballAround(const Field& nodes, const std::vector<double>& reach);
  static Ball ballAround(const Patch& patch, const Field& nodes);

  void findEdges(const Solid& solid, const ActiveMesh& mesh, const Field& nodes);
  void noteEdge(const Solid& solid, const Field& nodes, int node, int towards, double turn,
                std::vector<double>& turns) const;
  double edgeTurn(const Solid& solid, const Patch& patch, int direction) const;
  void addCells(const Solid& solid, const ActiveMesh& mesh, const Field& nodes);
  void addNodes(const ActiveMesh& mesh, const Field& nodes, const std::vector<double>& reach);
  void addProbePoints(const ActiveMesh& mesh, const Field& nodes, const std::vector<double>& reach,
                      const Reach& touching);
  void addCorners(const Patch& patch, int parts, const Field& nodes, double margin);
  void addMiddlesOfCell(const Patch& patch, const Field& nodes, double margin);
  void addLines(const Patch& patch, const Solid& solid, const Field& nodes, double margin);
  void addMiddles(int direction, int parts, double from, double to);
  void addEnds(int direction, int parts);
  double normalTurn(const Patch& patch, int c, int d) const;
  bool mayTouchCorner(const Solid& solid, const Patch& patch, const Field& nodes) const;
  bool isTilted(const Patch& patch, int direction) const;
  int partsAlong(const Solid& solid, int direction) const;
  bool divideAtEdge(const Solid& solid, const Patch& patch, const Field& nodes);
  void divideEvenly();
  bool mayTouchEdge(const Solid& solid, const Patch& patch, const Field& nodes) const;
  std::array<double, 2> strip(const Patch& patch, int direction, bool within, const Field& nodes) const;
  bool isFinestNearProbe(const Patch& patch) const;
  bool layersMayBeDented(const Patch& patch, const Field& nodes) const;
  bool isFlat(const Solid& solid) const;
  bool mayBeDented(const Solid& solid, const Patch& patch, const Field& nodes) const;
  bool isNearProbe(const Vec3& place) const;
  bool isPressedIn(const Vec3& place, double gap) const;
  bool touchesLetOut(const SurfacePoint& point) const;
  void listLetOut(const ActiveMesh& mesh, const SampleList& samples);
  int partsOf(const Patch& patch) const;
  double longestSide() const { return std::max(grid_.dx, grid_.dy); }  ///< of a finest cell [m]
  double spacing(int direction) const { return direction == kWarp ? grid_.dx : grid_.dy; }
  /// Largest distance of a finest cell's chord from an arc that turns by `turn` [rad]: length ·
  /// turn / 8 [m].
  double chord(double turn) const { return turn * longestSide() / 8.0; }
  void measure(const Solid& solid, double range, const ActiveMesh& mesh, const Field& nodes,
               const std::vector<double>& reach);
  void measureDistances(const Solid& solid, int count, const Field& points, Distances& distances);
  void addPoint(const SurfacePoint& point, const Vec3& place, double margin);
  void selectNear(int solid);
  void clearPoints();
  bool addGroup(int solid, const Field& motion, SampleList& samples);
  Vec3 elasticSlip(const ContactSample& sample) const;
  ContactSample startSample(int point, int solid, const SolidStep& step, const Field& motion) const;

  Grid grid_;
  const SolidSet& solids_;
  ContactLaw law_;
  const FrictionMemory& memory_;
  Team& team_;
  std::vector<int> probes_;       ///< that touch when the step starts, as solids
  std::vector<char> near_probe_;  ///< flags of the nodes near these
  std::vector<char> dented_;      ///< see dented()
  std::vector<int> let_out_;      ///< particles that were let out of an obstacle in the last step
  std::vector<char> is_let_out_;  ///< flags of these, by node
  // About the cloth and one solid with sharp edges, written by measure():
  Distances at_nodes_;
  std::vector<double> patch_margins_;              ///< gap below which points of a patch count, or -1 [m]
  std::vector<double> node_area_;                  ///< area that the nodes stand for as samples [m²]
  std::array<std::vector<double>, 2> edge_turns_;  ///< see findEdges(), along warp and weft [rad]
  /// Line of points across a cell: its place and the width that it stands for, as shares of the cell's
  /// length.
  struct Line {
    double at, width;
  };
  std::array<std::vector<Line>, 2> lines_;  ///< columns along weft and rows along warp, for addLines()
  std::vector<double> still_;               ///< a reach of zero [m]
  // Candidates for samples of one group:
  std::vector<SurfacePoint> points_;
  std::vector<double> margins_;  ///< largest gap at which each counts [m]
  Field places_;                 ///< their positions [m]
  Distances now_, then_;         ///< to the solid at the end and at the start of the step
  std::vector<int> near_;        ///< candidates that become samples
  std::vector<ContactSample> started_;
};

}  // namespace haptic_cloth
