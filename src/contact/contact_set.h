/// Contact of the cloth's surface with solids: samples, their energy, forces and stiffness.
#pragma once

#include <array>
#include <vector>

#include "contact/contact_law.h"
#include "contact/sample_packs.h"
#include "contact/shape.h"
#include "mesh/active_mesh.h"
#include "mesh/field.h"
#include "parallel/runs.h"

namespace haptic_cloth {

/// A point of the surface that may touch one solid in this step.
struct ContactSample {
  std::array<int, 4> nodes;       ///< corners of its cell
  std::array<double, 4> weights;  ///< bilinear, sum 1
  double area;                    ///< of cloth it stands for [m²]
  int solid;                      ///< index of the obstacle; kProbe: the probe
  double raised;          ///< by this much its gap counts larger: it began the step inside a solid [m]
  double clearance;       ///< its gap at the start of the step beyond that at which contact begins [m]
  double friction_force;  ///< μ times the normal force at the start of the step [N]
  Vec3 start;             ///< position relative to the solid at the start of the step [m]
  Vec3 start_normal;
};

/// Samples near solids, collected at the start of each step. Obstacles are sampled at the nodes, and at every
/// point of the finest grid in coarse cells on which they do not press evenly, so that these rest like fine
/// ones; the probe at points of at most a third of its radius apart. Model: docs/design.md.
class ContactSet {
 public:
  static constexpr int kProbe = -1;

  struct Options {
    double range;         ///< gap at which contact begins [m]
    double slip_speed;    ///< below it friction grows in from zero [m/s]
    double time_step;     ///< [s]
    double probe_radius;  ///< [m]
    double probe_friction;
  };

  ContactSet(const Grid& grid, const std::vector<Obstacle>& obstacles, const Options& options);

  /// Finds samples that may touch within a step and freezes their friction.
  /// @param nodes positions of all nodes [m]  @param reach how far each may move in the step [m]
  /// @param proxy null: no probe  @param proxy_reach how far that may move [m]
  void collect(const ActiveMesh& mesh, const Field& nodes, const std::vector<double>& reach,
               const Vec3* proxy, double proxy_reach);

  /// True where a probe at `proxy` would not touch the cloth.
  bool isClear(const ActiveMesh& mesh, const Field& nodes, const Vec3& proxy);

  /// Length of the range that evaluate() and curvature() share out, in steps of kLanes.
  int size() const { return static_cast<int>(samples_.size()); }

  /// Stops the nodes of samples that began the step inside a solid: they are let out, not thrown.
  void calm(Field& velocities) const;

  /// Adds the packs of the range that act on a node which is awake, and all of the probe's, counted from
  /// `first`.
  void appendAwake(const std::vector<char>& awake, int first, Runs& runs) const;

  using Energy = ContactEnergy;

  /// Energy of samples begin..end; leaves force and stiffness behind.
  Energy evaluate(int begin, int end, const Field& nodes, const Vec3& proxy);

  /// d · H⁺ d of samples begin..end at the last evaluation.
  double curvature(int begin, int end, const Field& d, const Vec3& d_proxy) const;

  /// Adds the energy gradient [N] at nodes begin..end, and the diagonal of H⁺ [N/m] at all nodes.
  void addGradient(int begin, int end, Field& gradient) const;
  void addDiagonal(Field& diagonal) const;

  /// Leaves in the slots how the gradient changes along d from `nodes`, the last evaluated point, exactly:
  /// the solids' curvature included. addChange() and proxyChange() then give it.
  void linearise(int begin, int end, const Field& nodes, const Vec3& proxy, const Field& d,
                 const Vec3& d_proxy);
  void addChange(int begin, int end, Field& change) const;
  Vec3 proxyChange() const;

  /// Gradient and diagonal at the proxy, from all probe samples.
  Vec3 proxyGradient() const;
  Vec3 proxyDiagonal() const;

  /// Force of the obstacles on the cloth [N], at the last evaluation.
  Vec3 obstacleForce() const;

  /// Largest factor of the step d from the last evaluated point that lets no probe sample come nearer than a
  /// tenth of its gap.
  double maxStep(const Field& d, const Vec3& d_proxy) const;

  bool probeTouched() const;  ///< some probe sample carries force
  double deepest() const;     ///< deepest penetration at the last evaluation [m]

 private:
  /// Samples of one solid in a row, as packs.
  struct Group {
    int solid, begin, end;
  };

  struct Entry {
    int sample;
    double weight;
  };

  Vec3 samplePosition(const ContactSample& sample, const Field& values) const;
  Distance distance(int solid, const Vec3& point, const Vec3& proxy) const;
  void sampleObstacles(const ActiveMesh& mesh, const Field& nodes, const std::vector<double>& reach);
  bool liesFlat(const Patch& patch, int solid, const Field& nodes) const;
  void sampleCell(const Patch& patch, int solid, const Field& nodes, double margin);
  void sampleProbe(const ActiveMesh& mesh, const Field& nodes, const std::vector<double>& reach,
                   const Vec3& proxy, double proxy_reach);
  double margin(const Patch& patch, const std::vector<double>& reach) const;
  static ContactSample nodePoint(int node, double area, int solid);
  static ContactSample surfacePoint(const Patch& patch, double u, double v, double area, int solid);
  void addSample(ContactSample sample, const Field& nodes, double margin, const Vec3& proxy);
  void beginGroup(int solid);
  void endGroup();
  void packGroup(const Group& group);
  SampleContext context(const Group& group, const Vec3& proxy) const;
  template <class Visit>
  void forGroups(int begin, int end, const Visit& visit) const;
  Vec3 normal(int sample) const;
  Vec3 diagonalOf(int sample) const;
  void buildRows(int nodes);

  Options options_;
  ContactLaw law_;
  Grid grid_;
  std::vector<Solid> obstacles_;
  std::vector<ContactSample> samples_;
  std::vector<Group> groups_;
  std::vector<SamplePack> packs_;
  Field gradient_;  ///< of the energy by the samples' positions [N]
  Field change_;    ///< of that along a direction [N]
  std::vector<int> rows_;
  std::vector<double> node_area_;  ///< scratch of sampleObstacles() [m²]
  std::vector<double> still_;      ///< scratch of isClear(): no reach [m]
  std::vector<Entry> entries_;
};

}  // namespace haptic_cloth
