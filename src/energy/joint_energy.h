/// The elements of the joint cost [M04]: tension, moment and shear force are unknowns beside the positions,
/// and what they miss of the fabric's law is a cost.
#pragma once

#include <vector>

#include "energy/internal_energy.h"

namespace haptic_cloth {

/// Element k has a deformation s (strain, curvature or angle) and an unknown force F, both per width. It acts
/// on its nodes with A F ∇s and costs ½ (A/K) (F - f(s))², f its law within the step, K the law's slope where
/// the step starts: in joule, and zero exactly where the law is met. Elements are numbered as in
/// InternalEnergy; twist, which is linear, is met exactly as there.
class JointEnergy {
 public:
  struct Costs {
    double stretch = 0.0, bend = 0.0, shear = 0.0;  ///< [J]
  };

  JointEnergy(const InternalEnergy& laws, const ActiveMesh& mesh);

  /// Most elements a mesh can have.
  int capacity() const { return static_cast<int>(elements_.capacity()); }
  int size() const { return laws_.elements(); }

  /// Starts a step at node positions x: scales the costs, writes the forces of the laws there.
  void begin(const Field& x, double* forces);

  /// Costs of elements begin..end; leaves their forces on the nodes in slots.
  Costs evaluate(int begin, int end, const Field& x, const double* forces);

  /// Leaves in the slots how the forces on the nodes change along (d, d_forces) from the last evaluated
  /// point.
  /// @return curvature of the elements' costs along it, to Gauss and Newton [J]
  double linearise(int begin, int end, const Field& x, const Field& d, const double* d_forces);

  /// Gradient of the whole cost: by positions into the slots, by forces into `gradient`.
  /// @param u h²/m times the residual force, of each node [m]
  void gradient(int begin, int end, const Field& x, const Field& u, double* gradient);

  /// Adds to nodes begin..end what the slots hold. @pre begin is a multiple of kPack
  void gather(int begin, int end, Field& sum) const { laws_.gather().add(begin, end, slots_, sum); }

  /// Diagonal of the cost's Hessian (Gauss-Newton) at the last evaluated point, by parts.
  /// @param weights h²/m of the nodes [m/N]
  /// @param laws by positions, that of the laws' costs [N/m], added to
  /// @param force_change by positions, of the nodes' forces: taut edges, across [N/m], added to
  /// @param forces by forces [J/(N/m)²], written
  void diagonal(const std::vector<double>& weights, Field& laws, Field& force_change, double* forces) const;

 private:
  /// ∇s as the element's slots take it: edges and triples have one, patches two.
  using Slope = std::array<Vec3, 2>;

  struct Element {
    double area, scale;           ///< A [m²], A/K
    double force, missing, rise;  ///< F, F - f(s), f'(s)
    Slope slope;
  };

  Slope slopeAt(int element, const Field& x) const;
  Slope slopeChange(int element, const Field& x, const Field& d) const;
  double rate(int element, const Field& d) const;
  void put(int element, const Slope& value, const Field& twisted);

  const InternalEnergy& laws_;
  const ActiveMesh& mesh_;
  std::vector<Element> elements_;
  Field slots_;
};

}  // namespace haptic_cloth
