#include "sim/cloth_objective.h"

#include <algorithm>
#include <array>
#include <cmath>

#include "simd/kernels.h"

namespace haptic_cloth {
namespace {

enum Part { kStretch, kBend, kShear, kSolids, kLayers, kFriction };

}  // namespace

double referenceAcceleration(const Vec3& gravity) {
  constexpr double kStandardGravity = 9.80665;  // [m/s²], used if a scene has no gravity
  return gravity.norm() > 0.0 ? gravity.norm() : kStandardGravity;
}

ClothObjective::ClothObjective(const Scene& scene, const ActiveMesh& mesh, const TimeIntegrator& integrator,
                               InternalEnergy& internal, ContactSet& contacts, Team& team)
    : mesh_(mesh),
      integrator_(integrator),
      internal_(internal),
      contacts_(contacts),
      team_(team),
      gravity_(scene.gravity),
      preconditioner_(scene.solver.minimizer.preconditioner),
      probes_(scene.probes.size()),
      awake_(mesh, internal, contacts) {
  for (const ProbeOptions& probe : scene.probes) {
    couplings_.push_back({probe.coupling_stiffness, probe.coupling_damping});
  }
  for (Proxies* list : {&proxies_, &proxy_motions_, &hold_forces_, &hold_torques_})
    list->assign(probes_.size(), Vec3::Zero());
  turning_.assign(probes_.size(), 0);
  middles_.assign(probes_.size(), Eigen::Matrix3d::Identity());
  held_.reserve(mesh.grid.particles());
  if (preconditioner_ == Preconditioner::Jacobi) blocks_.reserve(mesh.grid.particles());
  for (auto* list : {&start_, &inertial_, &nodes_, &motion_, &gradient_, &diagonal_}) {
    list->reserve(mesh.grid.particles());
  }
  for (auto* list : {&mass_, &moving_mass_}) list->reserve(padded(mesh.grid.particles()));
  for (Vector* v : {&inverse_diagonal_, &residual_weight_}) v->resize(capacity());
  unknown_order_.reserve(capacity());
  proxy_unknowns_.reserve(probes_.size());
  if (preconditioner_ == Preconditioner::Multilevel)
    multilevel_.emplace(mesh_, static_cast<int>(probes_.size()), team_);
}

template <class Visit>
void ClothObjective::forPresent(const Visit& visit) const {
  for (int k = 0; k < static_cast<int>(probes_.size()); ++k) {
    if (probes_[k].present) visit(k);
  }
}

void ClothObjective::begin(const Field& positions, const Field& velocities,
                           const std::vector<ProbeStep>& probes, const std::vector<HeldNode>& held) {
  probes_ = probes;
  held_ = held;
  present_ = 0;
  forPresent([this](int k) { probes_[k].unknown = present_++; });
  std::fill(turning_.begin(), turning_.end(), 0);
  for (const HeldNode& node : held_) {
    turning_[node.probe] |= node.end != node.start;
    middles_[node.probe] = contacts_.toMiddle(node.probe);
  }
  start_ = positions;
  for (auto* list : {&gradient_, &diagonal_}) list->resize(mesh_.nodes());
  motion_.clear(mesh_.nodes());  // zero for pinned nodes
  inertial_.resize(mesh_.nodes());
  for (int n = 0; n < mesh_.nodes(); ++n) {
    inertial_.set(n, positions[n] + integrator_.inertialMotion(n, velocities[n]));
  }
  nodes_ = positions;
  for (std::size_t k = 0; k < probes_.size(); ++k) proxies_[k] = probes_[k].proxy;
  for (Proxies* list : {&proxy_motions_, &hold_forces_, &hold_torques_})
    std::fill(list->begin(), list->end(), Vec3::Zero());
  mass_.assign(padded(mesh_.nodes()), 0.0);
  moving_mass_ = mass_;
  std::copy(mesh_.mass.begin(), mesh_.mass.end(), mass_.begin());
  for (int n = 0; n < mesh_.free; ++n) moving_mass_[n] = mesh_.mass[n] * (inertia(n) / inertia());

  double total_mass = 0.0;
  for (int n = 0; n < mesh_.free; ++n) total_mass += mesh_.mass[n];
  // The proxy has no mass. Over a step its coupling resists like this mass.
  const auto proxy_mass = [this](int k) { return timeStep() * timeStep() * couplingStiffness(k); };
  if (mesh_.free == 0) forPresent([&](int k) { total_mass += proxy_mass(k); });
  const double g = referenceAcceleration(gravity_);
  reference_ = total_mass * g * g;
  reference_acceleration_ = g * g;
  const auto weight = [&](double mass) { return 1.0 / (mass * reference_); };
  for (int n = 0; n < mesh_.free; ++n) residual_weight_[n] = weight(mesh_.mass[n]);
  for (const int c : {1, 2}) {
    residual_weight_.segment(c * mesh_.free, mesh_.free) = residual_weight_.head(mesh_.free);
  }
  forPresent(
      [&](int k) { residual_weight_.segment<3>(proxyAt(probes_[k])).setConstant(weight(proxy_mass(k))); });
  unknown_order_.set(std::array{0, mesh_.free, 2 * mesh_.free}, size());
  awake_.begin();
}

double ClothObjective::prescribedShare(const Field& to) {
  constexpr double kLeastRanges = 0.02;  // no law holds back what is prescribed
  if (!limitsSteps()) return 1.0;
  motion_.fill(0.0);
  for (int n = mesh_.free; n < mesh_.active(); ++n) motion_.set(n, to[n] - nodes_[n]);
  for (const HeldNode& held : held_) motion_.set(held.node, to[held.node] - nodes_[held.node]);
  mesh_.interpolateGhosts(motion_);
  std::fill(proxy_motions_.begin(), proxy_motions_.end(), Vec3::Zero());
  // A probe that turns what it holds has turned already, and the cloth follows it.
  const double share = contacts_.maxStep(nodes_, motion_, proxy_motions_, 1.0, kLeastRanges, turning_);
  motion_.fill(0.0);
  return share;
}

void ClothObjective::movePinned(const Field& to, double share) {
  for (int n = mesh_.free; n < mesh_.active(); ++n) nodes_.set(n, nodes_[n] + share * (to[n] - nodes_[n]));
}

void ClothObjective::placeHeld(int probe, Field& nodes) const {
  for (const HeldNode& held : held_) {
    if (held.probe == probe) nodes.set(held.node, proxies_[probe] + held.end);
  }
}

void ClothObjective::turnHeld(int probe, double made) {
  for (HeldNode& held : held_) {
    if (held.probe == probe) held.offset = partOfWay(held.start, held.end, made);
  }
}

double ClothObjective::shareOfWay(const Field& to, const Vector& x) {
  for (int n = 0; n < mesh_.nodes(); ++n) motion_.set(n, to[n] - nodes_[n]);
  forPresent([&](int k) { proxy_motions_[k] = x.segment<3>(proxyAt(probes_[k])) - proxies_[k]; });
  const double share = contacts_.maxStep(nodes_, motion_, proxy_motions_, 1.0);
  motion_.fill(0.0);
  return share;
}

void ClothObjective::setPinned(const Field& nodes) {
  for (int n = mesh_.free; n < mesh_.active(); ++n) nodes_.set(n, nodes[n]);
}

void ClothObjective::serialize(Archive& archive) {
  archive.each("present", probes_, &ProbeStep::present);
  archive.each("devices", probes_, &ProbeStep::device);
  archive("proxies", proxies_);
  archive("energies", energies_);
}

void ClothObjective::pack(const Field& nodes, Vector& x) const {
  packFree(nodes, x);
  forPresent([&](int k) { x.segment<3>(proxyAt(probes_[k])) = probes_[k].proxy; });
}

void ClothObjective::packFree(const Field& nodes, Vector& x) const {
  const auto copy = [&](int begin, int end) {
    for (int c = 0; c < 3; ++c) {
      const double* const from = nodes.coordinate(c).data();
      std::copy(from + begin, from + end, x.data() + c * mesh_.free + begin);
    }
  };
  team_.forRange(mesh_.free, copy, 3.0 * Team::kEntry);
}

void ClothObjective::unpack(const Vector& values, Field& nodes, Proxies& proxies) const {
  const auto copy = [&](int begin, int end) {
    for (int c = 0; c < 3; ++c) {
      const double* const from = values.data() + c * mesh_.free;
      std::copy(from + begin, from + end, nodes.coordinate(c).data() + begin);
    }
  };
  team_.forRange(mesh_.free, copy, 3.0 * Team::kEntry);
  forPresent([&](int k) { proxies[k] = values.segment<3>(proxyAt(probes_[k])); });
  mesh_.interpolateGhosts(nodes);
}

Motion ClothObjective::motion() const {
  return {mass_.data(), moving_mass_.data(), {gravity_.x(), gravity_.y(), gravity_.z()},
          inertia(),    start_.arrays(),     inertial_.arrays()};
}

double ClothObjective::evaluate(const Vector& x, Vector& gradient) {
  unpack(x, nodes_, proxies_);
  carryHeld(proxies_, true, nodes_);
  placeProbes();
  contacts_.noteMotion(nodes_);
  energies_ = team_.sum(
      awake_.elements().size(),
      [this](int from, int to) {
        Sums sums = Sums::Zero();
        awake_.elements().forPart(from, to,
                                  [&](int begin, int end) { sums += evaluateElements(begin, end); });
        return sums;
      },
      Team::kElement, awake_.elementOrder());
  contacts_.sumPairForces(mesh_.nodes());
  const Sums motion = team_.sum(
      awake_.nodes().size(),
      [this](int from, int to) {
        Sums sums = Sums::Zero();
        awake_.nodes().forPart(from, to, [&](int begin, int end) {
          sums[0] += gatherNodes(begin, std::min(end, mesh_.nodes()));
        });
        return sums;
      },
      Team::kNode);
  mesh_.handOverGhosts(gradient_);
  const double coupling = evaluateProbes(gradient);
  packFree(gradient_, gradient);
  awake_.clearSleepers(gradient);
  return energies_.sum() + motion[0] + coupling;
}

/// Writes the proxies' part of the gradient, including forces on held nodes.
/// @return energy and loss of the couplings [J]
double ClothObjective::evaluateProbes(Vector& gradient) {
  for (Proxies* list : {&hold_forces_, &hold_torques_}) std::fill(list->begin(), list->end(), Vec3::Zero());
  turn_work_ = 0.0;
  for (const HeldNode& held : held_) {
    turn_work_ += (middles_[held.probe] * gradient_[held.node]).dot(held.offset - held.start);
    hold_forces_[held.probe] -= gradient_[held.node];
    hold_torques_[held.probe] -= held.offset.cross(gradient_[held.node]);
    gradient_.set(held.node, Vec3::Zero());
  }
  double value = 0.0;
  forPresent([&](int k) {
    gradient.segment<3>(proxyAt(probes_[k])) = proxyGradient(k);
    value += couplingEnergy(k) + 0.5 * couplings_[k].damping * timeStep() * slip(k).squaredNorm();
  });
  return value;
}

void ClothObjective::forcesAtRest(Field& forces) const {
  forces = gradient_;
  for (int n = 0; n < mesh_.free; ++n)
    forces.add(n, moving_mass_[n] * inertia() * (inertial_[n] - start_[n]));
}

void ClothObjective::carryHeld(const Proxies& proxies, bool offsets, Field& nodes) const {
  if (held_.empty()) return;
  for (const HeldNode& held : held_) {
    nodes.set(held.node, offsets ? Vec3(proxies[held.probe] + held.offset) : proxies[held.probe]);
  }
  mesh_.interpolateGhosts(nodes);
}

void ClothObjective::placeProbes() {
  forPresent([this](int k) { contacts_.placeProbe(k, proxies_[k]); });
}

/// Velocity of the proxy minus that of its device [m/s].
Vec3 ClothObjective::slip(int probe) const {
  return (proxies_[probe] - probes_[probe].proxy) / timeStep() - probes_[probe].device_velocity;
}

Vec3 ClothObjective::couplingGradient(int probe, const Vec3& proxy) const {
  const ProbeStep& step = probes_[probe];
  const Vec3 slip = (proxy - step.proxy) / timeStep() - step.device_velocity;
  return couplings_[probe].stiffness * (proxy - step.device) + couplings_[probe].damping * slip;
}

Sums ClothObjective::evaluateElements(int begin, int end) {
  const int internal = internal_.size();
  const InternalEnergy::Energy e =
      internal_.evaluate(std::min(begin, internal), std::min(end, internal), nodes_);
  const ContactSet::Energy c =
      contacts_.evaluate(std::max(begin, internal) - internal, std::max(end, internal) - internal, nodes_);
  Sums sums = Sums::Zero();
  sums[kStretch] = e.stretch;
  sums[kBend] = e.bend;
  sums[kShear] = e.shear;
  sums[kSolids] = c.solids;
  sums[kLayers] = c.layers;
  sums[kFriction] = c.friction;
  return sums;
}

/// Collects the gradient of nodes begin..end. @return their energy of motion and gravity [J]
double ClothObjective::gatherNodes(int begin, int end) {
  const double energy = kernels().evaluateMotion(motion(), begin, end, nodes_.arrays(), gradient_.arrays());
  internal_.addGradient(begin, end, gradient_);
  contacts_.addGradient(begin, end, gradient_);
  return energy;
}

void ClothObjective::setMotion(const Vector& d) {
  unpack(d, motion_, proxy_motions_);
  carryHeld(proxy_motions_, false, motion_);
}

Objective::Along ClothObjective::along(const Vector& d, double slope) {
  setMotion(d);
  const double form = formAlongMotion(false, true).sum(), step = newtonStep(slope, form);
  return {form, limitsSteps() ? contacts_.maxStep(nodes_, motion_, proxy_motions_, step) : step};
}

ClothObjective::QuadraticForm ClothObjective::quadraticForm(const Vector& d, bool deforms) {
  setMotion(d);
  return formAlongMotion(true, deforms);
}

double ClothObjective::maxStep(const Vector& d, double most) {
  if (!limitsSteps()) return most;
  setMotion(d);
  return contacts_.maxStep(nodes_, motion_, proxy_motions_, most);
}

ClothObjective::QuadraticForm ClothObjective::formAlongMotion(bool whole_motion, bool deforms) {
  const int internal = internal_.size();
  const auto of_part = [&](int from, int to) {
    Sums sums = Sums::Zero();
    awake_.elements().forPart(from, to, [&](int begin, int end) {
      if (deforms)
        sums[0] += internal_.quadraticForm(std::min(begin, internal), std::min(end, internal), motion_);
      sums[1] +=
          contacts_.quadraticForm(std::max(begin, internal) - internal, std::max(end, internal) - internal,
                                  motion_, proxy_motions_, whole_motion);
    });
    return sums;
  };
  const Sums elements = team_.sum(awake_.elements().size(), of_part, Team::kElement, awake_.elementOrder());
  const Sums moving = team_.sum(
      awake_.nodes().size(),
      [&](int from, int to) {
        Sums sums = Sums::Zero();
        awake_.nodes().forPart(from, to, [&](int begin, int end) {
          sums[0] += kernels().motionQuadraticForm(motion(), begin, end, motion_.arrays());
        });
        return sums;
      },
      Team::kEntry);
  double others = elements[1] + moving[0];
  forPresent([&](int k) { others += couplingStiffness(k) * proxy_motions_[k].squaredNorm(); });
  return {elements[0], others};
}

void ClothObjective::fitMultilevel() {
  proxy_unknowns_.clear();
  forPresent([this](int k) { proxy_unknowns_.push_back({k, proxyAt(probes_[k]), couplingStiffness(k)}); });
  multilevel_->fit(internal_, contacts_, integrator_, awake_.flags(), held_, proxy_unknowns_);
}

void ClothObjective::fitPreconditioner() {
  if (multilevel_) return fitMultilevel();
  diagonal_.fill(0.0);
  if (preconditioner_ == Preconditioner::Jacobi) {
    blocks_.clear(mesh_.nodes());
    internal_.addBlocks(0, 1, blocks_);
    for (int n = 0; n < mesh_.nodes(); ++n) diagonal_.add(n, blocks_[n].head<3>());
    contacts_.addDiagonal(diagonal_);
    mesh_.handOverGhosts(diagonal_, 0.25);
  }
  forPresent([this](int k) {
    Vec3 diagonal = Vec3::Constant(couplingStiffness(k));
    if (preconditioner_ == Preconditioner::Jacobi) diagonal += contacts_.proxyDiagonal(k);
    for (const HeldNode& held : held_) {
      if (held.probe == k)
        diagonal += (diagonal_[held.node].array() + mesh_.mass[held.node] * inertia(held.node)).matrix();
    }
    inverse_diagonal_.segment<3>(proxyAt(probes_[k])) = diagonal.cwiseInverse();
  });
  for (int n = 0; n < mesh_.free; ++n) {
    diagonal_.set(n, (diagonal_[n].array() + mesh_.mass[n] * inertia(n)).inverse());
  }
  for (int n = 0; n < mesh_.free; ++n) {
    if (!awake_.contains(n)) diagonal_.set(n, Vec3::Zero());
  }
  for (const HeldNode& held : held_) diagonal_.set(held.node, Vec3::Zero());
  packFree(diagonal_, inverse_diagonal_);
}

void ClothObjective::precondition(const Vector& gradient, Vector& z) {
  if (multilevel_) return multilevel_->apply(gradient, z);
  z.head(size()) = inverse_diagonal_.head(size()).cwiseProduct(gradient.head(size()));
}

double ClothObjective::residual(const Vector& gradient) const {
  const Sums square = team_.sum(
      size(),
      [&](int begin, int end) {
        Sums sums = Sums::Zero();
        sums[0] = gradient.segment(begin, end - begin)
                      .cwiseAbs2()
                      .dot(residual_weight_.segment(begin, end - begin));
        return sums;
      },
      Team::kEntry, unknown_order_);
  return std::sqrt(square[0] + awake_.sleepersSquare());
}

InternalEnergy::Energy ClothObjective::fabricEnergy() const {
  return {energies_[kStretch], energies_[kBend], energies_[kShear]};
}

double ClothObjective::contactEnergy() const { return energies_[kSolids] + energies_[kLayers]; }

double ClothObjective::solidEnergy() const { return energies_[kSolids]; }

double ClothObjective::layerEnergy() const { return energies_[kLayers]; }

double ClothObjective::frictionPotential() const { return energies_[kFriction]; }

Vec3 ClothObjective::proxyGradient(int probe) const {
  return couplingGradient(probe, proxies_[probe]) + contacts_.proxyGradient(probe) - hold_forces_[probe];
}

double ClothObjective::couplingEnergy(int probe) const {
  return 0.5 * couplings_[probe].stiffness * (proxies_[probe] - probes_[probe].device).squaredNorm();
}

double ClothObjective::couplingEnergy() const {
  double energy = 0.0;
  forPresent([&](int k) { energy += couplingEnergy(k); });
  return energy;
}

/// Potential of friction and coupling dampers [J].
double ClothObjective::lossPotential() const {
  double loss = energies_[kFriction];
  forPresent([&](int k) { loss += 0.5 * couplings_[k].damping * timeStep() * slip(k).squaredNorm(); });
  return loss;
}

double ClothObjective::storedAndLost() const {
  return energies_.head<kFriction>().sum() + couplingEnergy() + lossPotential();
}

double ClothObjective::motionCost() const {
  const double h = timeStep();
  double cost = 0.0;
  for (int n = 0; n < mesh_.free; ++n) cost += 0.5 * h * h / mesh_.mass[n] * gradient_[n].squaredNorm();
  return cost;
}

Vec3 ClothObjective::netForce() const {
  Vec3 force = Vec3::Zero();
  for (int n = 0; n < mesh_.free; ++n) {
    if (awake_.contains(n)) force -= gradient_[n];
  }
  return force;
}

Vec3 ClothObjective::freeMotion(const Vec3& net_force) const {
  double inertia_of_all = 0.0;
  for (int n = 0; n < mesh_.free; ++n) inertia_of_all += mesh_.mass[n] * inertia(n);
  return product(inverse(contacts_.stiffness() + isotropic(inertia_of_all)), net_force);
}

Vec3 ClothObjective::pinForce() const {
  Vec3 force = Vec3::Zero();
  for (int n = mesh_.free; n < mesh_.active(); ++n) force += gradient_[n];
  return force;
}

double ClothObjective::workUndone() const {
  double work = 0.0;
  for (int n = 0; n < mesh_.free; ++n) work -= gradient_[n].dot(nodes_[n] - start_[n]);
  return work;
}

double ClothObjective::pinWork() const {
  double work = 0.0;
  for (int n = mesh_.free; n < mesh_.active(); ++n) work += gradient_[n].dot(nodes_[n] - start_[n]);
  return work;
}

}  // namespace haptic_cloth
