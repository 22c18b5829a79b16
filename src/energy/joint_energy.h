/// Elements of the joint cost [M04]: tension, moment and shear force are unknowns beside the
/// positions, and their deviation from the fabric's laws is a cost.
#pragma once

#include <vector>

#include "energy/internal_energy.h"

namespace haptic_cloth {

/// Element k has a deformation s (strain, curvature or angle) and an unknown force F, both per
/// width. It exerts A F ∇s on its nodes and costs ½ (A/K) (F - f(s))² [J]. f is its law within the
/// step, K the slope of the law at the start of the step. The cost is zero only if the law is met.
/// Elements are numbered as in InternalEnergy. Twist is linear and follows its law exactly, as
/// there.
class JointEnergy {
 public:
  struct Costs {
    double stretch = 0.0, bend = 0.0, shear = 0.0;  ///< [J]
  };

  JointEnergy(const InternalEnergy& laws, const ActiveMesh& mesh);

  /// Largest number of elements of any mesh.
  int capacity() const { return static_cast<int>(elements_.capacity()); }
  int size() const { return laws_.elements(); }

  /// Starts a step at node positions x: scales the costs and writes the forces of the laws there.
  void begin(const Field& x, double* forces);

  /// Evaluates the costs of elements begin..end, and writes their forces on the nodes to the slots.
  Costs evaluate(int begin, int end, const Field& x, const double* forces);

  /// Writes the change of the forces on the nodes along (d, d_forces) at the last evaluated point
  /// to the slots.
  /// @return quadratic form of the Gauss-Newton Hessian of the elements' costs [J]
  double linearise(int begin, int end, const Field& x, const Field& d, const double* d_forces);

  /// Gradient of the whole cost: by positions to the slots, by forces to `gradient`.
  /// @param u h²/m times the residual force of each node [m]
  void gradient(int begin, int end, const Field& x, const Field& u, double* gradient);

  /// Adds the sums of their slots to nodes begin..end. @pre begin is a multiple of kPack
  void gather(int begin, int end, Field& sum) const { laws_.gather().add(begin, end, slots_, sum); }

  /// Diagonal of the Gauss-Newton Hessian of the cost at the last evaluated point, by parts.
  /// @param weights h²/m of the nodes [m/N]
  /// @param laws by positions, from the costs of the laws [N/m]; added to
  /// @param force_change by positions, change of the nodes' forces by the turning of taut edges
  /// [N/m]; added to
  /// @param forces by forces [J/(N/m)²]; written
  void diagonal(const std::vector<double>& weights, Field& laws, Field& force_change, double* forces) const;

 private:
  /// ∇s in the form of the element's slots: one vector for edges and triples, two for patches.
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
