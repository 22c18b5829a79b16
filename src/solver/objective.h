/// Interface between the minimizer and a problem.
#pragma once

#include <Eigen/Core>

#include "parallel/block_order.h"

namespace haptic_cloth {

using Vector = Eigen::VectorXd;

/// A potential Φ(x) of the first size() entries of x. Vectors may be longer, so that a changing
/// problem needs no new memory; entries beyond the end are not written and have no meaning. Only
/// evaluate() moves the point; along() and fitPreconditioner() refer to the last evaluated one.
class Objective {
 public:
  virtual ~Objective() = default;

  virtual int size() const = 0;

  /// Order in which threads take blocks of vectors of size() entries: as they are numbered.
  virtual const BlockOrder& order() const {
    static const BlockOrder none;
    return none;
  }

  /// Evaluates Φ(x) [J] and writes its gradient.
  virtual double evaluate(const Vector& x, Vector& gradient) = 0;

  struct Along {
    /// Quadratic form d · H⁺ d; H⁺ is the positive part of the second derivative, element by
    /// element. Friction may count more, as its force changes over the whole of d (frictionForm()),
    /// so d should be about as long as the step.
    double quadratic_form;
    /// Newton's step along d, or 1 if the quadratic form is zero, or the largest admissible factor of
    /// d if that is less.
    double step;
  };

  /// Quadratic form and step along d at the last evaluated point.
  /// @param slope of Φ along d [J]
  virtual Along along(const Vector& d, double slope) = 0;

  /// Bends d, the direction of the last call of along(), around constraints that would stop a step along it
  /// before the factor `step` of d. @return whether d changed
  virtual bool keepClear(Vector& /*d*/, double /*step*/) { return false; }

  /// Newton's step for a slope and a quadratic form [J].
  static double newtonStep(double slope, double form) { return form > 0.0 ? -slope / form : 1.0; }

  /// Fits P ≈ H⁻¹, symmetric positive definite, to the last evaluated point.
  /// @param thoroughly whether a dearer and better fit pays, because the solve is long
  virtual void fitPreconditioner(bool thoroughly) = 0;

  /// z = P g.
  virtual void precondition(const Vector& gradient, Vector& z) = 0;

  /// Norm of a gradient, to be compared with the tolerance.
  virtual double residual(const Vector& gradient) const = 0;
};

}  // namespace haptic_cloth
