/// Contact of the cloth's surface with solids: samples, their energy, forces and stiffness.
#pragma once

#include <array>
#include <vector>

#include "contact/contact_law.h"
#include "contact/shape.h"
#include "mesh/active_mesh.h"
#include "mesh/field.h"

namespace haptic_cloth {

/// A point of the surface that may touch one solid in this step.
struct ContactSample {
  std::array<int, 4> nodes;       ///< corners of its cell
  std::array<double, 4> weights;  ///< bilinear, sum 1
  double area;                    ///< of cloth it stands for [m²]
  int solid;                      ///< index of the obstacle; kProbe: the probe
  double raised;          ///< by this much its gap counts larger: it began the step inside a solid [m]
  double friction_force;  ///< μ times the normal force at the start of the step [N]
  Vec3 start;             ///< position relative to the solid at the start of the step [m]
  Vec3 start_normal;
};

/// Samples near solids, collected at the start of each step. Obstacles are sampled at every point of the
/// finest grid, whatever the mesh there, so that a coarse cell rests like a fine one; the probe at points of
/// at most a third of its radius apart. Model: docs/design.md.
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
  /// @param nodes positions of all nodes [m]  @param speed of the fastest node [m/s]  @param proxy null: no
  /// probe
  void collect(const ActiveMesh& mesh, const Field& nodes, double speed, const Vec3* proxy,
               double probe_reach);

  /// True where a probe at `proxy` would not touch the cloth.
  bool isClear(const ActiveMesh& mesh, const Field& nodes, const Vec3& proxy);

  int size() const { return static_cast<int>(samples_.size()); }

  /// Stops the nodes of samples that began the step inside a solid: they are let out, not thrown.
  void calm(Field& velocities) const;

  struct Energy {
    double contact = 0.0;   ///< stored [J]
    double friction = 0.0;  ///< potential of the friction force: what a slip so far costs [J]
  };

  /// Energy of samples begin..end; leaves force and stiffness in the samples' slots.
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

  /// Largest factor of the step d that lets no probe sample come nearer than a tenth of its gap.
  double maxStep(const Field& nodes, const Vec3& proxy, const Field& d, const Vec3& d_proxy) const;

  bool probeTouched() const;  ///< some probe sample carries force
  double deepest() const;     ///< deepest penetration at the last evaluation [m]

 private:
  struct Slot {
    Vec3 gradient;  ///< of the energy by the sample's position [N]
    Vec3 normal;
    double gap;                                  ///< [m]
    double normal_stiffness, tangent_stiffness;  ///< [N/m]
    double pressing;                             ///< area times pressure [N]
    Vec3 change;                                 ///< of the gradient along a direction [N]
  };

  struct Entry {
    int sample;
    double weight;
  };

  Vec3 samplePosition(const ContactSample& sample, const Field& values) const;
  Distance distance(int solid, const Vec3& point, const Vec3& proxy) const;
  void sampleObstacles(const ActiveMesh& mesh, const Field& nodes, double margin);
  void sampleProbe(const ActiveMesh& mesh, const Field& nodes, double margin, const Vec3& proxy);
  void addSample(const Patch& patch, double u, double v, double area, int solid, const Field& nodes,
                 double margin, const Vec3& proxy);
  void buildRows(int nodes);

  Options options_;
  ContactLaw law_;
  Grid grid_;
  std::vector<Solid> obstacles_;
  std::vector<ContactSample> samples_;
  std::vector<Slot> slots_;
  std::vector<int> rows_;
  std::vector<Entry> entries_;
};

}  // namespace haptic_cloth
