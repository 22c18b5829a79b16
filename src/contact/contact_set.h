/// Contact of the cloth's surface with solids: samples, their energy, forces and stiffness.
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
#include "parallel/runs.h"

namespace haptic_cloth {

/// A point of the surface, within a cell or at a node.
struct SurfacePoint {
  std::array<int, 4> nodes;       ///< corners of its cell
  std::array<double, 4> weights;  ///< bilinear, sum 1
  double area;                    ///< of cloth it stands for [m²]
};

/// A point of the surface that may touch one solid in this step.
struct ContactSample : SurfacePoint {
  int solid = 0;                ///< obstacles first, then probes
  double raised = 0.0;          ///< by this much its gap counts larger: it began the step inside a solid [m]
  double clearance = 0.0;       ///< its gap at the start of the step beyond that at which contact begins [m]
  double friction_force = 0.0;  ///< μ times the normal force at the start of the step [N]
  Vec3 start = Vec3::Zero();  ///< where it gets to if the solid carries it along; for a probe relative to the
                              ///< proxy [m]
  Vec3 carry = Vec3::Zero();  ///< how far that is from where it starts [m]
  Vec3 start_normal = Vec3::Zero();
};

/// Samples near solids, collected at the start of each step. Obstacles are sampled at the nodes, and at every
/// point of the finest grid in coarse cells on which they do not press evenly, so that these rest like fine
/// ones, and closer at sharp edges; the probe at points of at most a third of its radius apart. Model:
/// decision 0010.
class ContactSet {
 public:
  struct Options {
    double range;       ///< gap at which contact begins [m]
    double slip_speed;  ///< below it friction grows in from zero [m/s]
    double time_step;   ///< [s]
  };

  /// A probe in the step to come.
  struct Reach {
    int probe;
    double distance;  ///< its proxy may move so far [m]
  };

  ContactSet(const Grid& grid, const std::vector<Obstacle>& obstacles,
             const std::vector<ProbeOptions>& probes, const Options& options);

  /// The obstacles take one step towards where moveObstacle() sent them.
  void advance();
  void moveObstacle(int obstacle, const Pose& pose) { targets_[obstacle] = pose; }
  bool obstaclesMove() const;  ///< some have not arrived
  int obstacles() const { return obstacles_; }
  const Solid& obstacle(int k) const { return solids_[k]; }
  double obstacleSpeed(int k) const;  ///< of its fastest point in the step in hand [m/s]

  /// Where the solids are and are sent: samples and their friction are found anew in each step.
  void serialize(Archive& archive);

  /// A probe at the start of a step: its proxy [m] and how it turns meanwhile.
  void startProbe(int probe, const Vec3& proxy, const Quat& before, const Quat& after);

  /// What is evaluated next has the probe's proxy there [m].
  void placeProbe(int probe, const Vec3& proxy) { solids_[obstacles_ + probe].place(proxy); }

  /// Finds samples that may touch within a step and freezes their friction.
  /// @param nodes positions of all nodes [m]  @param reach how far each may move in the step [m]
  /// @param touching the probes that count, started
  void collect(const ActiveMesh& mesh, const Field& nodes, const std::vector<double>& reach,
               const std::vector<Reach>& touching);

  /// True where the probe would not touch the cloth. @pre it was started
  bool isClear(const ActiveMesh& mesh, const Field& nodes, int probe);

  /// Length of the range that evaluate() and curvature() share out, in steps of kPack.
  int size() const { return static_cast<int>(samples_.size()); }
  int capacity() const { return static_cast<int>(samples_.capacity()); }  ///< for which there is room

  /// A node of the cell that sample k of the range lies in.
  int firstNode(int k) const { return samples_[k].nodes[0]; }

  /// Stops the nodes of samples that began the step inside a solid: they are let out, not thrown.
  void calm(Field& velocities) const;

  /// Marks the nodes that calm() stops with 1.
  void markLetOut(std::vector<char>& nodes) const;

  /// Adds the packs of the range that act on a node which is awake, and all of the probe's, counted from
  /// `first`.
  void appendAwake(const std::vector<char>& awake, int first, Runs& runs) const;

  using Energy = ContactEnergy;

  /// Energy of samples begin..end; leaves force and stiffness behind.
  Energy evaluate(int begin, int end, const Field& nodes);

  /// d · H⁺ d of samples begin..end at the last evaluation. @param d_proxies of all probes
  /// @param whole_way friction as all of d meets it, not its first bit: sliding cloth does not stick
  double curvature(int begin, int end, const Field& d, const std::vector<Vec3>& d_proxies,
                   bool whole_way) const;

  /// Adds the energy gradient [N] at nodes begin..end, and the diagonal of H⁺ [N/m] at all nodes.
  void addGradient(int begin, int end, Field& gradient) const;
  void addDiagonal(Field& diagonal) const;

  /// Adds the stiffness of all samples of a probe, or of the obstacles, to their nodes, to each its share
  /// [N/m].
  void addSprings(int probe, Blocks& blocks) const;
  static constexpr int kObstacles = -1;

  /// Leaves in the slots how the gradient changes along d from `nodes`, the last evaluated point, exactly:
  /// the solids' curvature included. addChange() and proxyChange() then give it.
  void linearise(int begin, int end, const Field& nodes, const Field& d, const std::vector<Vec3>& d_proxies);
  void addChange(int begin, int end, Field& change) const;
  Vec3 proxyChange(int probe) const;

  /// Gradient and diagonal at a proxy, from all of its samples.
  Vec3 proxyGradient(int probe) const;
  /// Torque of the cloth on a probe about its proxy, at the last evaluation [N·m].
  /// @param nodes positions of that evaluation [m]
  Vec3 proxyTorque(int probe, const Field& nodes) const;
  Vec3 proxyDiagonal(int probe) const;

  /// Force of the obstacles on the cloth [N], at the last evaluation.
  Vec3 obstacleForce() const;

  /// What moving obstacles have worked on the cloth in the step, by the forces of the last evaluation [J].
  double obstacleWork() const;

  /// Obstacles let cloth out by pushing it anew in every step, which is work: what the contact energy of the
  /// last evaluation will change by when the next step begins with it [J].
  double letOutWork() const;

  /// Largest factor of the step d from the last evaluated point that lets no probe sample come nearer than a
  /// tenth of its gap.
  double maxStep(const Field& d, const std::vector<Vec3>& d_proxies) const;

  /// Appends the nodes of cells that press on a probe, some more than once.
  void touchedNodes(int probe, std::vector<int>& nodes) const;

  bool probeTouched(int probe) const;  ///< some sample of it carries force
  double deepest() const;              ///< deepest penetration at the last evaluation [m]

 private:
  /// Samples of one solid in a row, as packs.
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
  int partsOf(const Patch& patch) const;
  int sampleCapacity() const;
  /// How far a finest cell's chord is from an arc that turns by `turn` [rad]: its length times that over 8
  /// [m].
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
  ContactLaw law_;
  Grid grid_;
  int obstacles_;              ///< how many of the solids are; the others are probes
  std::vector<Solid> solids_;  ///< at the end of the step in hand
  std::vector<Solid> before_;  ///< at its start
  std::vector<Pose> targets_;  ///< of the obstacles
  std::vector<ContactSample> samples_;
  std::vector<ContactSample> apart_;  ///< scratch of siftPoints()
  std::vector<Group> groups_;
  std::vector<SamplePack> packs_;
  Field gradient_;  ///< of the energy by the samples' positions [N]
  Field change_;    ///< of that along a direction [N]
  std::vector<int> rows_;
  std::vector<double> node_area_;      ///< scratch of sampleObstacles() [m²]
  std::vector<double> node_gaps_;      ///< by measure() [m]
  Field node_normals_;                 ///< the same
  std::vector<double> patch_margins_;  ///< the same [m]
  std::vector<SurfacePoint> points_;   ///< that may become samples of the group in hand
  std::vector<double> margins_;        ///< how near these must be [m]
  Field places_;                       ///< where they are [m]
  /// Of these to the solid at the end of the step and at its start.
  std::array<std::vector<double>, 2> sample_gaps_;
  std::array<Field, 2> sample_normals_;
  std::vector<double> still_;  ///< scratch of isClear(): no reach [m]
  std::vector<Entry> entries_;
};

}  // namespace haptic_cloth
