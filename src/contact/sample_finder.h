/// Search for contact samples at the start of a step.
#pragma once

#include <optional>
#include <vector>

#include "contact/candidates.h"
#include "contact/cloth_gaps.h"
#include "contact/contact_law.h"
#include "contact/edge_division.h"
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
  SampleFinder(const SampleFinder&) = delete;  // its parts refer to one another
  SampleFinder& operator=(const SampleFinder&) = delete;

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

  void addCells(const Solid& solid, const ActiveMesh& mesh, const Field& nodes);
  void addNodes(const ActiveMesh& mesh, const Field& nodes, const std::vector<double>& reach);
  void addProbePoints(const ActiveMesh& mesh, const Field& nodes, const std::vector<double>& reach,
                      const Reach& touching);
  bool isFinestNearProbe(const Patch& patch) const;
  bool layersMayBeDented(const Patch& patch, const Field& nodes) const;
  bool isFlat(const Solid& solid) const;
  bool mayBeDented(const Solid& solid, const Patch& patch, const Field& nodes) const;
  bool isNearProbe(const Vec3& place) const;
  bool isPressedIn(const Vec3& place, double gap) const;
  bool touchesLetOut(const SurfacePoint& point) const;
  void listLetOut(const ActiveMesh& mesh, const SampleList& samples);
  int partsOf(const Patch& patch) const;
  /// Largest distance of a finest cell's chord from an arc that turns by `turn` [rad]: length ·
  /// turn / 8 [m].
  double chord(double turn) const { return turn * grid_.longestSpacing() / 8.0; }
  void selectNear(int solid);
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
  // About one solid:
  ClothGaps gaps_;  ///< from the solid with sharp edges
  EdgeDivision edges_;
  std::vector<double> node_area_;  ///< area that the nodes stand for as samples [m²]
  CellLines lines_;                ///< scratch
  std::vector<double> still_;      ///< a reach of zero [m]
  // About one group of samples:
  Candidates candidates_;
  Distances now_, then_;   ///< of these from the solid at the end and at the start of the step
  std::vector<int> near_;  ///< candidates that become samples
  std::vector<ContactSample> started_;
};

}  // namespace haptic_cloth
