/// Contact of the cloth with solids: samples, their energy, forces and stiffness.
#pragma once

#include <algorithm>
#include <array>
#include <vector>

#include "contact/contact_law.h"
#include "contact/sample_packs.h"
#include "contact/shape.h"
#include "mesh/active_mesh.h"
#include "mesh/block.h"
#include "mesh/field.h"
#include "parallel/parallel_for.h"
#include "parallel/runs.h"

namespace haptic_cloth {

/// Point of the cloth's surface, within a cell or at a node.
struct SurfacePoint {
  std::array<int, 4> nodes;       ///< corners of its cell
  std::array<double, 4> weights;  ///< bilinear weights, sum 1
  double area;                    ///< area of cloth that it stands for [m²]
};

/// Point of the surface that may touch one solid in this step.
struct ContactSample : SurfacePoint {
  int solid = 0;  ///< index of the solid: obstacles first, then probes
  /// Offset added to the gap if the sample began the step inside a solid [m].
  double raised = 0.0;
  /// Gap at the start of the step beyond the range of contact [m].
  double clearance = 0.0;
  double friction_force = 0.0;  ///< μ times the normal force at the start of the step [N]
  /// Position if the solid carries it along; for a probe relative to the proxy [m].
  Vec3 start = Vec3::Zero();
  Vec3 carry = Vec3::Zero();  ///< displacement to that position from the start of the step [m]
  Vec3 start_normal = Vec3::Zero();
};

/// Samples near solids, collected at the start of each step. Obstacles are sampled at the nodes,
/// and at every point of the finest grid in coarse cells on which they do not press evenly, so that
/// these rest like fine ones. At sharp edges the samples are denser. Probes are sampled at points
/// at most a third of their radius apart. Model: decision 0010.
class ContactSet {
 public:
  struct Options {
    double range;       ///< gap at which contact begins [m]
    double slip_speed;  ///< speed below which friction is smoothed [m/s]
    double time_step;   ///< [s]
  };

  /// Reach of a probe in the next step.
  struct Reach {
    int probe;
    double distance;  ///< largest expected motion of its proxy [m]
  };

  ContactSet(const Grid& grid, const std::vector<Obstacle>& obstacles,
             const std::vector<ProbeOptions>& probes, const Options& options, Team& team);

  /// Moves the obstacles one step towards their targets.
  void advance();
  void moveObstacle(int obstacle, const Pose& pose) { targets_[obstacle] = pose; }
  bool obstaclesMove() const;  ///< tells whether an obstacle has not arrived or just moved
  int obstacles() const { return obstacles_; }
  const Solid& obstacle(int k) const { return solids_[k]; }
  double obstacleSpeed(int k) const;  ///< speed of its fastest point in the current step [m/s]

  /// Saves or loads poses and targets of the obstacles; samples and friction are found in each
  /// step.
  void serialize(Archive& archive);

  /// Places a probe at the start of a step: its proxy [m], and its orientation at start and end.
  void startProbe(int probe, const Vec3& proxy, const Quat& before, const Quat& after);

  /// Moves the proxy of a probe for the next evaluation [m].
  void placeProbe(int probe, const Vec3& proxy) { solids_[obstacles_ + probe].place(proxy); }

  /// Finds samples that may touch within a step and freezes their friction.
  /// @param nodes positions of all nodes [m]
  /// @param reach largest expected displacement of each node in the step [m]
  /// @param touching probes to be sampled, after startProbe()
  void collect(const ActiveMesh& mesh, const Field& nodes, const std::vector<double>& reach,
               const std::vector<Reach>& touching);

  /// Tells whether the probe does not touch the cloth. @pre startProbe()
  bool isClear(const ActiveMesh& mesh, const Field& nodes, int probe);

  /// Number of samples: length of the range that evaluate() and curvature() divide in multiples of
  /// kPack.
  int size() const { return static_cast<int>(samples_.size()); }

  /// Number of samples that memory is reserved for.
  int capacity() const { return static_cast<int>(samples_.capacity()); }

  /// One node of the cell of sample k.
  int firstNode(int k) const { return samples_[k].nodes[0]; }

  /// Stops the nodes of samples that began the step inside a solid: they are ejected, not thrown.
  void calm(Field& velocities) const;

  /// Sets the flags of the nodes that calm() stops to 1.
  void markLetOut(std::vector<char>& nodes) const;

  /// Adds the packs that act on an awake node, and all packs of probes, to `runs`, counted from
  /// `first`.
  void appendAwake(const std::vector<char>& awake, int first, Runs& runs) const;

  using Energy = ContactEnergy;

  /// Evaluates samples begin..end, and stores their forces and stiffness. @return their energy
  Energy evaluate(int begin, int end, const Field& nodes);

  /// Quadratic form d · H⁺ d of samples begin..end at the last evaluation.
  /// @param d_proxies directions of all probes
  /// @param whole_way friction of probes as over the whole of d instead of its beginning: sliding
  /// cloth does not stick
  double curvature(int begin, int end, const Field& d, const std::vector<Vec3>& d_proxies,
                   bool whole_way) const;

  /// Add the energy gradient [N] at nodes begin..end, and the diagonal of H⁺ [N/m] at all nodes.
  void addGradient(int begin, int end, Field& gradient) const;
  void addDiagonal(Field& diagonal) const;

  /// Adds the stiffness of all samples of a probe, or of the obstacles, to their nodes in
  /// proportion to the weights [N/m].
  void addSprings(int probe, Blocks& blocks) const;
  static constexpr int kObstacles = -1;

  /// Stores how the gradient of each sample changes along d at `nodes`, the last evaluated point.
  /// The change includes the curvature of the solids. addChange() and proxyChange() collect it.
  void linearise(int begin, int end, const Field& nodes, const Field& d, const std::vector<Vec3>& d_proxies);
  void addChange(int begin, int end, Field& change) const;
  Vec3 proxyChange(int probe) const;

  /// Gradient [N] at a proxy, from all of its samples.
  Vec3 proxyGradient(int probe) const;
  /// Torque of the cloth on a probe about its proxy, at the last evaluation [N·m].
  /// @param nodes positions of that evaluation [m]
  Vec3 proxyTorque(int probe, const Field& nodes) const;
  Vec3 proxyDiagonal(int probe) const;

  /// Force of the obstacles on the cloth at the last evaluation [N].
  Vec3 obstacleForce() const;

  /// Work of moving obstacles on the cloth in the step, by the forces of the last evaluation [J].
  double obstacleWork() const;

  /// Work of obstacles that eject cloth by pushing it again in every step: the change of the
  /// contact energy of the last evaluation when the next step begins [J].
  double letOutWork() const;

  /// Largest factor of d from the last evaluated point at which no probe sample uses up more than
  /// 0.9 of its gap.
  double maxStep(const Field& d, const std::vector<Vec3>& d_proxies) const;

  /// Appends the nodes of cells that press on a probe, with repetitions.
  void touchedNodes(int probe, std::vector<int>& nodes) const;

  bool probeTouched(int probe) const;  ///< a sample of the probe carries force
  double deepest() const;              ///< largest penetration depth at the last evaluation [m]

 private:
  /// Consecutive packs of samples of one solid.
  struct Group {
    int solid, begin, end;
  };

  struct Entry {
    int sample;
    double weight;
  };

  bool isProbe(int solid) const { return solid >= obstacles_; }
  Vec3 origin(int solid) const { return isProbe(solid) ? solids_[solid].position() : Vec3::Zero(); }
  Vec3 motionOf(int solid, const std::vector<Vec3>& d_proxies) const {
    return isProbe(solid) ? d_proxies[solid - obstacles_] : Vec3::Zero();
  }
  template <class Value>
  Vec3 sumOf(int probe, const Value& value) const;
  static Vec3 at(const SurfacePoint& point, const Field& values);
  void sampleObstacles(const ActiveMesh& mesh, const Field& nodes, const std::vector<double>& reach);
  void measure(int solid, double range, const ActiveMesh& mesh, const Field& nodes,
               const std::vector<double>& reach);
  void measureDistances(const Solid& solid, int count, const Field& points, std::vector<double>& gaps,
                        Field& normals);
  int partsOf(const Patch& patch) const;
  int sampleCapacity() const;
  /// Largest distance of a finest cell's chord from an arc that turns by `turn` [rad]: length ·
  /// turn / 8 [m].
  double chord(double turn) const { return turn * std::max(grid_.dx, grid_.dy) / 8.0; }
  void sampleCell(const Patch& patch, int parts, const Field& nodes, double margin);
  void sampleProbe(const ActiveMesh& mesh, const Field& nodes, const std::vector<double>& reach,
                   const Reach& touching);
  static SurfacePoint nodePoint(int node, double area);
  static SurfacePoint surfacePoint(const Patch& patch, double u, double v, double area);
  double raise(int solid, double gap) const;
  void addPoint(const SurfacePoint& point, const Vec3& place, double margin);
  void siftPoints(int solid);
  ContactSample started(const SurfacePoint& point, int solid, const Vec3& place, const Distance& now,
                        const Distance& then, bool still) const;
  void beginGroup(int solid);
  void endGroup();
  void packGroup(const Group& group);
  SampleContext context(const Group& group) const;
  template <class Visit>
  void forGroups(int begin, int end, const Visit& visit) const;
  Vec3 normal(int sample) const;
  Block blockOf(int sample) const;
  void buildRows(int nodes);

  Options options_;
  Team& team_;
  ContactLaw law_;
  Grid grid_;
  int obstacles_;              ///< number of obstacles; the other solids are probes
  std::vector<Solid> solids_;  ///< at the end of the current step
  std::vector<Solid> before_;  ///< at its start
  std::vector<Pose> targets_;  ///< poses of the obstacles
  std::vector<ContactSample> samples_;
  std::vector<ContactSample> started_;  ///< scratch of siftPoints()
  std::vector<int> near_;               ///< scratch of siftPoints(), points that become samples
  std::vector<Group> groups_;
  std::vector<SamplePack> packs_;
  Field gradient_;  ///< energy gradient by the samples' positions [N]
  Field change_;    ///< its change along a direction [N]
  std::vector<int> rows_;
  std::vector<double> node_area_;      ///< scratch of sampleObstacles() [m²]
  std::vector<double> node_gaps_;      ///< written by measure() [m]
  Field node_normals_;                 ///< written by measure()
  std::vector<double> patch_margins_;  ///< written by measure() [m]
  std::vector<SurfacePoint> points_;   ///< candidates for samples of the current group
  std::vector<double> margins_;        ///< largest gap at which each counts [m]
  Field places_;                       ///< their positions [m]
  /// Their gaps and normals for the solid at the end and at the start of the step.
  std::array<std::vector<double>, 2> sample_gaps_;
  std::array<Field, 2> sample_normals_;
  std::vector<double> still_;  ///< scratch of isClear(): a reach of zero [m]
  std::vector<Entry> entries_;
};

}  // namespace haptic_cloth
