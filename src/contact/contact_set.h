/// Contact of the cloth with solids and with itself.
#pragma once

#include <algorithm>
#include <limits>
#include <optional>
#include <vector>

#include "contact/contact_law.h"
#include "contact/sample_finder.h"
#include "contact/sample_forces.h"
#include "contact/sample_gather.h"
#include "contact/sample_list.h"
#include "contact/self_contact.h"
#include "contact/solid_set.h"
#include "mesh/active_mesh.h"
#include "mesh/block.h"
#include "mesh/field.h"
#include "parallel/parallel_for.h"
#include "parallel/runs.h"

namespace haptic_cloth {

/// Samples of the cloth near solids. They are found at the start of each step (SampleFinder) and
/// evaluated in the solve (SampleForces); their forces are summed up for nodes (SampleGather),
/// probes and obstacles (here). SelfContact does the same for pairs of parts of the cloth; in ranges
/// they follow the samples.
class ContactSet {
 public:
  struct Options {
    double range;                                   ///< gap at which contact begins [m]
    double slip_speed;                              ///< speed below which friction is smoothed [m/s]
    double time_step;                               ///< length of the first step [s]
    std::optional<SelfContact::Options> self = {};  ///< empty: the cloth passes through itself
  };
  using Reach = SampleFinder::Reach;
  struct Energy {
    double solids = 0.0, layers = 0.0;  ///< stored between the cloth and solids, and between its layers [J]
    double friction = 0.0;              ///< potential of friction [J]
  };

  ContactSet(const Grid& grid, const std::vector<Obstacle>& obstacles,
             const std::vector<ProbeOptions>& probes, const Options& options, Team& team);
  ContactSet(const ContactSet&) = delete;  // its parts refer to one another
  ContactSet& operator=(const ContactSet&) = delete;

  /// Starts a step: moves the obstacles towards their targets.
  /// @param time_step its length [s]  @param nodes of the cloth [m]
  void advance(double time_step, const Field& nodes);
  void moveObstacle(int obstacle, const Pose& pose) { solids_.moveObstacle(obstacle, pose); }
  bool obstaclesMove() const { return solids_.obstaclesMove(); }  ///< see SolidSet
  int obstacles() const { return solids_.obstacles(); }
  const Solid& obstacle(int k) const { return solids_[k]; }
  /// Speed of the fastest point of an obstacle in the current step [m/s].
  double obstacleSpeed(int k) const { return solids_.pathLength(k) / time_step_; }

  /// Saves or loads poses and targets of the obstacles, and what friction remembers; samples are
  /// found in each step.
  void serialize(Archive& archive);

  /// Places a probe at the start of a step: its proxy [m], and its orientation at start and end.
  /// @param velocity of the proxy, expected [m/s]
  void startProbe(int probe, const Vec3& proxy, const Quat& before, const Quat& after,
                  const Vec3& velocity = Vec3::Zero()) {
    solids_.startProbe(probe, proxy, before, after, time_step_ * velocity);
  }

  /// Moves the proxy of a probe for the next evaluation [m].
  void placeProbe(int probe, const Vec3& proxy) { solids_.placeProbe(probe, proxy); }
  /// Turns a probe from its orientation at the start of the step for the next evaluation.
  void turnProbe(int probe, const Mat3& turn) { solids_.turnProbe(probe, turn); }

  /// Must follow a change of the mesh.
  void rebuild(const ActiveMesh& mesh) {
    if (self_) self_->rebuild(mesh);
  }

  /// Finds samples of probes that may touch within a step and freezes their friction.
  /// @param nodes positions of all nodes [m]
  /// @param reach largest expected displacement of each node in the step [m]
  /// @param motion expected displacement [m]
  /// @param touching probes to be sampled, after startProbe()
  void collectProbes(const ActiveMesh& mesh, const Field& nodes, const std::vector<double>& reach,
                     const Field& motion, const std::vector<Reach>& touching) {
    finder_.findProbes(mesh, nodes, reach, motion, touching, samples_);
  }

  /// The same for obstacles. @pre collectProbes()
  void collectObstacles(const ActiveMesh& mesh, const Field& nodes, const std::vector<double>& reach,
                        const Field& motion);

  /// The same for pairs of parts of the cloth. The parameters are those of PairFinder::find().
  /// @pre collectProbes()
  void collectPairs(const ActiveMesh& mesh, const Field& nodes, const ConstArrays& normals,
                    const PairFinder::Reach& reach) {
    if (self_) self_->collect(mesh, nodes, normals, reach, finder_.dented());
  }

  /// Prepares hasRoom() for positions of the nodes [m].
  void beginChange(const ActiveMesh& mesh, const Field& nodes) {
    if (self_) self_->beginChange(mesh, nodes);
  }

  /// Tells whether a change of the mesh may move the surface in a cell by `moved` without making it
  /// cross another part of the cloth [m]. @pre beginChange()
  bool hasRoom(const ActiveMesh& mesh, const Field& nodes, const Cell& cell, double moved) {
    return !self_ || self_->hasRoom(mesh, nodes, cell, moved);
  }

  /// Tells whether the surface in a cell could sink into an obstacle if it moved by `moved` [m].
  bool maySink(const ActiveMesh& mesh, const Field& nodes, const Cell& cell, double moved) const;

  /// Starts a step, in which all parts may turn out to be smooth; see ClothTree.
  void forgetRough() {
    if (self_) self_->forgetRough();
  }

  bool meetsItself() const { return self_.has_value(); }
  const std::optional<SelfContact>& self() const { return self_; }  ///< unset: it passes through itself

  /// Smallest distance of pairs at `nodes`, the last evaluated point; infinite without pairs [m].
  double smallestSelfGap(const Field& nodes) {
    return self_ ? self_->smallestDistance(nodes) : std::numeric_limits<double>::infinity();
  }

  /// Tells whether no parts of the cloth that are not listed as a pair can have met on the straight way from
  /// the start to the end of the step, both positions of all nodes [m].
  /// @param deviates nodes moved farther than the reach of collectPairs() allowed
  bool unlistedStayApart(const ActiveMesh& mesh, const Field& start, const Field& end, bool deviates) {
    return !self_ || self_->unlistedStayApart(mesh, start, end, deviates);
  }

  /// The same for listed pairs. @pre the last evaluation was at `end`
  bool pairsStayApart(const Field& start, const Field& end) const {
    return !self_ || self_->pairsStayApart(start, end);
  }

  /// See SampleFinder::wayOut(). @pre startProbe()
  std::optional<Vec3> wayOut(const ActiveMesh& mesh, const Field& nodes, int probe) {
    return finder_.wayOut(mesh, nodes, probe);
  }

  /// Remembers the friction of all samples and pairs for the next step.
  /// @param normals of the surface at the nodes, as for collectPairs()
  void rememberFriction(const ActiveMesh& mesh, const ConstArrays& normals);

  /// Number of samples and pairs: length of the range that evaluate() and quadraticForm() divide in
  /// multiples of kPack.
  int size() const { return samples_.size() + (self_ ? self_->size() : 0); }

  /// Number of samples and pairs that memory is reserved for.
  int capacity() const { return samples_.capacity() + (self_ ? self_->capacity() : 0); }

  /// One node of the cell of sample k.
  int firstNode(int k) const { return samples_[k].nodes[0]; }

  /// Sets the flags of the nodes of samples that began the step inside a solid to 1: they are ejected.
  void markEjected(std::vector<char>& nodes) const;

  /// Sets the flags of the nodes of all samples and pairs to 1: only they can touch anything in the step.
  void markListed(std::vector<char>& nodes) const;

  /// Sets the flags of the nodes that a moving obstacle touched at the last evaluation to 1.
  /// @return whether there are any
  bool markCarried(std::vector<char>& nodes) const;

  /// Adds the packs that act on an awake node, and all packs of probes, to `runs`, counted from
  /// `first`.
  void appendAwake(const std::vector<char>& awake, int first, Runs& runs) const;

  /// Notes where the nodes are for the next evaluation.
  void noteMotion(const Field& nodes) {
    if (self_) self_->noteMotion(nodes);
  }

  /// Sums up the forces of pairs at the last evaluation for addGradient().
  void sumPairForces(int nodes) {
    if (self_) self_->sumForces(nodes);
  }

  /// Evaluates samples and pairs begin..end, and stores their forces and stiffness. @return their energy
  Energy evaluate(int begin, int end, const Field& nodes);

  /// Quadratic form d · H⁺ d of samples begin..end at the last evaluation.
  /// @param d_proxies directions of all probes
  /// @param whole_motion friction of probes as over the whole of d, even if its beginning is stiffer:
  /// sliding cloth does not stick
  double quadraticForm(int begin, int end, const Field& d, const Proxies& d_proxies, bool whole_motion) const;

  /// Add the energy gradient [N] at nodes begin..end, and the diagonal of H⁺ [N/m] at all nodes.
  void addGradient(int begin, int end, Field& gradient) const {
    gather_.add(begin, end, forces_.gradient(), gradient);
    if (self_) self_->addGradient(begin, end, gradient);
  }
  void addDiagonal(Field& diagonal) const;

  /// Adds the stiffness of all samples of a probe, or of the obstacles, to their nodes in
  /// proportion to the weights [N/m].
  void addSprings(int probe, Blocks& blocks) const;
  static constexpr int kObstacles = -1;

  /// Stores how the gradient of each sample changes along d at `nodes`, the last evaluated point.
  /// The change includes the curvature of the solids. addChange() and proxyChange() collect it.
  void linearise(int begin, int end, const Field& nodes, const Field& d, const Proxies& d_proxies) {
    forces_.linearise(begin, end, nodes, d, d_proxies);
  }
  void addChange(int begin, int end, Field& change) const {
    gather_.add(begin, end, forces_.change(), change);
  }
  Vec3 proxyChange(int probe) const;

  /// Gradient [N] at a proxy, from all of its samples.
  Vec3 proxyGradient(int probe) const;
  /// Torque of the cloth on a probe about its proxy, at the last evaluation [N·m].
  /// @param nodes positions of that evaluation [m]
  Vec3 proxyTorque(int probe, const Field& nodes) const;
  /// Diagonals of the stiffness against a shift of the proxy [N/m], and against its turn [N·m].
  Vec3 proxyDiagonal(int probe) const;
  Vec3 turnDiagonal(int probe) const;

  /// Stiffness of contact against a motion of the cloth as a whole at the last evaluation [N/m].
  Block stiffness() const;

  /// Force of the obstacles on the cloth at the last evaluation [N].
  Vec3 obstacleForce() const;

  /// Work of moving obstacles, and of probes that turn as prescribed, on the cloth in the step, by the forces
  /// of the last evaluation [J]. They have turned with the cloth, and count as they are in the middle of a
  /// solid's turn: those of its end, along the way from start to end, would take energy from cloth that turns
  /// along without any change.
  double workOfSolids() const;

  /// Work of obstacles that eject cloth by pushing it again in every step: the change of the
  /// contact energy of the last evaluation when the next step begins [J].
  double ejectionWork() const;

  /// Largest factor of d up to `most`, from `nodes`, the last evaluated point, at which no probe sample
  /// and no pair uses up more than 0.9 of its gap, nor a pair comes nearer than `least_ranges` times its
  /// range. A solve stays apart by the law, so the default only keeps distances from rounding to zero.
  double maxStep(const Field& nodes, const Field& d, const Proxies& d_proxies, double most,
                 double least_ranges = 1e-6) {
    const double step = std::min(most, forces_.maxStep(d, d_proxies));
    return self_ ? self_->maxStep(nodes, d, step, least_ranges) : step;
  }

  /// Adds to `change` what pairs change in d so that a step of `step` along it brings none of them too near
  /// (SelfContact::keepClear()).
  bool keepClear(const Field& nodes, const Field& d, double step, Field& change) const {
    return self_ && self_->keepClear(nodes, d, step, change);
  }

  /// Ways of the nodes in the step if the fastest obstacle carried the cloth with it [m].
  /// @param x nodes at the start of the step [m]
  /// @return whether an obstacle moves so far that cloth on its way would begin deep inside it
  bool carry(const Field& x, Field& ways) const;

  /// Appends the nodes of cells that press on a probe, with repetitions.
  void touchedNodes(int probe, std::vector<int>& nodes) const;

  bool probeTouched(int probe) const;  ///< a sample of the probe carries force
  double deepest() const;              ///< largest penetration depth at the last evaluation [m]

 private:
  template <class Visit>
  void forSamples(int probe, const Visit& visit) const;

  double slip_speed_, time_step_;  ///< [m/s], [s]
  Grid grid_;
  ContactLaw law_;
  SolidSet solids_;
  FrictionMemory memory_;
  SampleFinder finder_;
  SampleList samples_;
  SampleForces forces_;
  SampleGather gather_;
  std::optional<SelfContact> self_;
};

}  // namespace haptic_cloth
