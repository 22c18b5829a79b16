#include "sim/joint_objective.h"

#include <algorithm>

namespace haptic_cloth {

JointObjective::JointObjective(ClothObjective& step, const ActiveMesh& mesh, const InternalEnergy& internal,
                               ContactSet& contacts, Team& team)
    : step_(step), mesh_(mesh), contacts_(contacts), team_(team), elements_(internal, mesh) {
  for (auto* list : {&nodes_, &motion_, &residual_, &gradient_, &diagonal_, &stiffness_}) {
    list->reserve(mesh.grid.particles());
  }
  weight_.reserve(mesh.grid.particles());
  inverse_diagonal_.resize(capacity());
  proxy_weight_.assign(step.probeSteps().size(), 0.0);
  for (Proxies* list : {&proxies_, &proxy_motions_, &proxy_residuals_}) {
    list->assign(step.probeSteps().size(), Proxy());
  }
  hold_.assign(step.probeSteps().size(), Vec3::Zero());
}

template <class Visit>
void JointObjective::forPresent(const Visit& visit) const {
  const std::vector<ProbeStep>& probes = step_.probeSteps();
  for (int k = 0; k < static_cast<int>(probes.size()); ++k) {
    if (probes[k].present) visit(k, step_.proxyAt(probes[k]));
  }
}

void JointObjective::begin(const Vector& start, const Vector& positions, Vector& unknowns) {
  const double h = step_.timeStep();
  nodes_ = step_.nodes();  // for nodes that do not move
  motion_.clear(mesh_.nodes());
  for (auto* list : {&residual_, &gradient_, &diagonal_, &stiffness_}) list->clear(mesh_.nodes());
  weight_.assign(mesh_.nodes(), 0.0);
  for (int n = 0; n < mesh_.free; ++n) weight_[n] = h * h / mesh_.mass[n];
  forPresent([this](int k, int) { proxy_weight_[k] = step_.couplingStiffness(k); });
  for (const HeldNode& held : step_.held()) {
    proxy_weight_[held.probe] += mesh_.mass[held.node] * step_.inertia(held.node);
    weight_[held.node] = 0.0;
  }
  forPresent([this](int k, int) { proxy_weight_[k] = 1.0 / proxy_weight_[k]; });
  step_.unpack(start, nodes_, proxies_);
  step_.placeHeld(proxies_, nodes_);
  elements_.begin(nodes_, unknowns.data() + step_.size());
  unknowns.head(step_.size()) = positions.head(step_.size());
}

double JointObjective::evaluate(const Vector& x, Vector& gradient) {
  step_.unpack(x, nodes_, proxies_);
  step_.placeHeld(proxies_, nodes_);
  forPresent([this](int k, int) { contacts_.placeProbe(k, proxies_[k].position); });
  evaluateElements(x.data() + step_.size());
  costs_.motion = residualForces();
  double* by_force = gradient.data() + step_.size();
  team_.forRange(elements_.size(),
                 [&](int begin, int end) { elements_.gradient(begin, end, nodes_, residual_, by_force); });
  team_.forRange(contacts_.size(), [&](int begin, int end) {
    contacts_.linearise(begin, end, nodes_, residual_, proxy_residuals_);
  });
  gatherGradient(gradient);
  return costs_.total();
}

void JointObjective::evaluateElements(const double* forces) {
  const Sums costs = team_.sum(elements_.size(), [&](int begin, int end) {
    const JointEnergy::Costs c = elements_.evaluate(begin, end, nodes_, forces);
    Sums sums = Sums::Zero();
    sums[0] = c.stretch;
    sums[1] = c.bend;
    sums[2] = c.shear;
    return sums;
  });
  team_.forRange(contacts_.size(), [&](int begin, int end) { contacts_.evaluate(begin, end, nodes_); });
  costs_.stretch = costs[0];
  costs_.bend = costs[1];
  costs_.shear = costs[2];
}

/// Writes h²/m times the residual force to residual_, and likewise for proxies. @return E^n
double JointObjective::residualForces() {
  team_.forRange(mesh_.nodes(), [&](int begin, int end) {
    for (int n = begin; n < end; ++n) residual_.set(n, step_.motionGradient(n, nodes_[n]));
    elements_.gather(begin, end, residual_);
    contacts_.addGradient(begin, end, residual_);
  });
  mesh_.handOverGhosts(residual_);
  takeHeld(residual_);
  double cost = team_.sum(mesh_.nodes(), [&](int begin, int end) {
    Sums sums = Sums::Zero();
    for (int n = begin; n < end; ++n) {
      sums[0] += 0.5 * weight_[n] * residual_[n].squaredNorm();
      residual_.set(n, weight_[n] * residual_[n]);
    }
    return sums;
  })[0];
  // A proxy has no mass; it answers over a step like the mass h² times its coupling stiffness.
  forPresent([&](int k, int) {
    const Vec3 force =
        step_.couplingGradient(k, proxies_[k].position) + contacts_.proxyGradient(k) + hold_[k];
    proxy_residuals_[k].position = proxy_weight_[k] * force;
    cost += 0.5 * force.dot(proxy_residuals_[k].position);
  });
  mesh_.interpolateGhosts(residual_);
  step_.moveHeld(proxy_residuals_, residual_);
  return cost;
}

/// Moves the forces on held nodes from `forces` to hold_.
void JointObjective::takeHeld(Field& forces) {
  std::fill(hold_.begin(), hold_.end(), Vec3::Zero());
  for (const HeldNode& held : step_.held()) {
    hold_[held.probe] += forces[held.node];
    forces.set(held.node, Vec3::Zero());
  }
}

/// Sums the changes of force along a field, which are in the slots.
void JointObjective::gatherAlong(const Field& field) {
  team_.forRange(mesh_.nodes(), [&](int begin, int end) {
    for (int n = begin; n < end; ++n) gradient_.set(n, mesh_.mass[n] * step_.inertia(n) * field[n]);
    elements_.gather(begin, end, gradient_);
    contacts_.addChange(begin, end, gradient_);
  });
  mesh_.handOverGhosts(gradient_);
  takeHeld(gradient_);
}

/// Gradient by positions: the sum of the changes of force along the residual.
void JointObjective::gatherGradient(Vector& gradient) {
  gatherAlong(residual_);
  step_.packFree(gradient_, gradient);
  forPresent([&](int k, int at) {
    gradient.segment<3>(at) =
        step_.couplingStiffness(k) * proxy_residuals_[k].position + contacts_.proxyChange(k) + hold_[k];
  });
}

Objective::Along JointObjective::along(const Vector& d, double slope) {
  step_.unpack(d, motion_, proxy_motions_);
  step_.moveHeld(proxy_motions_, motion_);
  const double form = changeOfForces(d.data() + step_.size());
  return {form, contacts_.maxStep(nodes_, motion_, proxy_motions_, newtonStep(slope, form))};
}

/// Quadratic form of the Gauss-Newton Hessian along (motion_, proxy_motions_, d_forces).
double JointObjective::changeOfForces(const double* d_forces) {
  const Sums laws = team_.sum(elements_.size(), [&](int begin, int end) {
    Sums sums = Sums::Zero();
    sums[0] = elements_.linearise(begin, end, nodes_, motion_, d_forces);
    return sums;
  });
  team_.forRange(contacts_.size(), [&](int begin, int end) {
    contacts_.linearise(begin, end, nodes_, motion_, proxy_motions_);
  });
  gatherAlong(motion_);
  double quadratic_form = laws[0] + team_.sum(mesh_.free, [&](int begin, int end) {
    Sums sums = Sums::Zero();
    for (int n = begin; n < end; ++n) sums[0] += weight_[n] * gradient_[n].squaredNorm();
    return sums;
  })[0];
  forPresent([&](int k, int) {
    const Vec3 change =
        step_.couplingStiffness(k) * proxy_motions_[k].position + contacts_.proxyChange(k) + hold_[k];
    quadratic_form += proxy_weight_[k] * change.squaredNorm();
  });
  return quadratic_form;
}

void JointObjective::fitPreconditioner(bool /*thoroughly*/) {
  auto by_force = inverse_diagonal_.segment(step_.size(), elements_.size());
  diagonal_.fill(0.0);
  stiffness_.fill(0.0);
  elements_.diagonal(weight_, diagonal_, stiffness_, by_force.data());
  by_force = by_force.cwiseInverse();
  if (step_.preconditioner() != Preconditioner::None) {
    contacts_.addDiagonal(stiffness_);
  } else {  // forces keep their entries: they have a unit of their own
    diagonal_.fill(0.0);
    stiffness_.fill(0.0);
  }
  mesh_.handOverGhosts(diagonal_, 0.25);
  mesh_.handOverGhosts(stiffness_, 0.25);
  for (int n = 0; n < mesh_.free; ++n) {
    stiffness_.set(n, stiffness_[n].array() + mesh_.mass[n] * step_.inertia(n));
    diagonal_.set(n, diagonal_[n] + weight_[n] * stiffness_[n].cwiseAbs2());
  }
  forPresent([this](int k, int at) {
    Vec3 laws = Vec3::Zero(), force = contacts_.proxyDiagonal(k).array() + step_.couplingStiffness(k);
    for (const HeldNode& held : step_.held()) {
      if (held.probe != k) continue;
      laws += diagonal_[held.node];
      force += stiffness_[held.node];
    }
    inverse_diagonal_.segment<3>(at) = (laws + proxy_weight_[k] * force.cwiseAbs2()).cwiseInverse();
  });
  for (int n = 0; n < mesh_.free; ++n) diagonal_.set(n, diagonal_[n].cwiseInverse());
  for (const HeldNode& held : step_.held()) diagonal_.set(held.node, Vec3::Zero());
  step_.packFree(diagonal_, inverse_diagonal_);
}

void JointObjective::precondition(const Vector& gradient, Vector& z) {
  z.head(size()) = inverse_diagonal_.head(size()).cwiseProduct(gradient.head(size()));
}

double JointObjective::residual(const Vector&) const { return step_.residualOf(costs_.total()); }

}  // namespace haptic_cloth
