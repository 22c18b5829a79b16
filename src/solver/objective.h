/// What the minimizer needs to know of a problem: nothing else.
#pragma once

#include <Eigen/Core>

namespace haptic_cloth {

using Vector = Eigen::VectorXd;

/// A potential Φ(x) of the first size() entries of x; vectors may be longer, so that a changing problem needs
/// no new memory, and what lies past the end is not written and has no meaning. evaluate() is the only call
/// that moves the point; curvature() refers to the last one evaluated.
class Objective {
 public:
  virtual ~Objective() = default;

  virtual int size() const = 0;

  /// Φ(x) [J]; writes its gradient.
  virtual double evaluate(const Vector& x, Vector& gradient) = 0;

  struct Along {
    double curvature;  ///< d · H⁺ d, H⁺ the positive part of the second derivative, element by element
    double max_step;   ///< largest admissible factor of d
  };

  /// What lies along d from the last evaluated point.
  virtual Along along(const Vector& d) = 0;

  /// Fits P ≈ H⁻¹, symmetric positive definite, to the last evaluated point.
  virtual void fitPreconditioner() = 0;

  /// z = P g.
  virtual void precondition(const Vector& gradient, Vector& z) = 0;

  /// Norm of a gradient that the tolerance is compared with.
  virtual double residual(const Vector& gradient) const = 0;
};

}  // namespace haptic_cloth
