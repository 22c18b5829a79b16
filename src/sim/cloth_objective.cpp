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
    // On an arc its points leave the straight way by at most a tenth of the radius.
    const double most_turn = std::sqrt(0.2 * probe.radius / probe.extent());
    couplings_.push_back(
        {probe.coupling_stiffness, probe.coupling_damping, turnRadiusSquared(probe), most_turn});
  }
  for (Proxies* list : {&proxies_, &proxy_motions_}) list->assign(probes_.size(), Proxy());
  for (auto* list : {&hold_forces_, &hold_torques_}) list->assign(probes_.size(), Vec3::Zero());
  held_.reserve(mesh.grid.particles());
  if (preconditioner_ == Preconditioner::Jacobi) blocks_.reserve(mesh.grid.particles());
  for (auto* list : {&start_, &inertial_, &nodes_, &motion_, &detour_, &gradient_, &diagonal_}) {
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
  probe_unknowns_ = 0;
  forPresent([this](int k) {
    probes_[k].unknown = probe_unknowns_;
    probe_unknowns_ += probes_[k].unknowns();
  });
  start_ = positions;
  for (auto* list : {&gradient_, &diagonal_}) list->resize(mesh_.nodes());
  motion_.clear(mesh_.nodes());  // zero for pinned nodes
  inertial_.resize(mesh_.nodes());
  for (int n = 0; n < mesh_.nodes(); ++n) {
    inertial_.set(n, positions[n] + integrator_.inertialMotion(n, velocities[n]));
  }
  nodes_ = positions;
  for (std::size_t k = 0; k < probes_.size(); ++k) proxies_[k] = {probes_[k].proxy, Vec3::Zero()};
  std::fill(proxy_motions_.begin(), proxy_motions_.end(), Proxy());
  for (auto* list : {&hold_forces_, &hold_torques_}) std::fill(list->begin(), list->end(), Vec3::Zero());
  mass_.assign(padded(mesh_.nodes()), 0.0);
  moving_mass_ = mass_;
  std::copy(mesh_.mass.begin(), mesh_.mass.end(), mass_.begin());
  for (int n = 0; n < mesh_.free; ++n) moving_mass_[n] = mesh_.mass[n] * (inertia(n) / inertia());

  double total_mass = 0.0;
  for (int n = 0; n < mesh_.free; ++n) total_mass += mesh_.mass[n];
  // The proxy has no mass. Over a step its coupling resists like this mass.
  const auto proxy_mass = [this](int k) { return timeStep() * timeStep() * couplingStiffness(k); };
  if (mesh_.free == 0) forPresent([&](int k) { total_mass += proxy_mass(k); });
  acceleration_unit_ = referenceAcceleration(gravity_);
  residual_unit_ = total_mass * acceleration_unit_ * acceleration_unit_;
  const auto weight = [&](double mass) { return 1.0 / (mass * residual_unit_); };
  for (int n = 0; n < mesh_.free; ++n) residual_weight_[n] = weight(mesh_.mass[n]);
  for (const int c : {1, 2}) {
    residual_weight_.segment(c * mesh_.free, mesh_.free) = residual_weight_.head(mesh_.free);
  }
  forPresent([&](int k) {
    const int at = proxyAt(probes_[k]);
    residual_weight_.segment<3>(at).setConstant(weight(proxy_mass(k)));
    if (probes_[k].turns)
      residual_weight_.segment<3>(at + 3).setConstant(weight(proxy_mass(k) * couplings_[k].square));
  });
  unknown_order_.set(std::array{0, mesh_.free, 2 * mesh_.free}, size());
  awake_.begin();
}

double ClothObjective::pinnedShare(const Field& to) {
  constexpr double kLeastRanges = 0.02;  // no law holds back what is prescribed
  if (!limitsSteps()) return 1.0;
  motion_.fill(0.0);
  for (int n = mesh_.free; n < mesh_.active(); ++n) motion_.set(n, to[n] - nodes_[n]);
  mesh_.interpolateGhosts(motion_);
  std::fill(proxy_motions_.begin(), proxy_motions_.end(), Proxy());
  const double share = contacts_.maxStep(nodes_, motion_, proxy_motions_, 1.0, kLeastRanges);
  motion_.fill(0.0);
  return share;
}

void ClothObjective::movePinned(const Field& to, double share) {
  for (int n = mesh_.free; n < mesh_.active(); ++n) nodes_.set(n, nodes_[n] + share * (to[n] - nodes_[n]));
}

double ClothObjective::shareOfWay(const Field& to, const Vector& x) {
  for (int n = 0; n < mesh_.nodes(); ++n) motion_.set(n, to[n] - nodes_[n]);
  forPresent([&](int k) {
    const int at = proxyAt(probes_[k]);
    proxy_motions_[k].position = x.segment<3>(at) - proxies_[k].position;
    if (probes_[k].turns) proxy_motions_[k].turn = x.segment<3>(at + 3) - proxies_[k].turn;
  });
  const double share = contacts_.maxStep(nodes_, motion_, proxy_motions_, turnLimit(1.0));
  motion_.fill(0.0);
  return share;
}

void ClothObjective::setPinned(const Field& nodes) {
  for (int n = mesh_.free; n < mesh_.active(); ++n) nodes_.set(n, nodes[n]);
}

void ClothObjective::serialize(Archive& archive) {
  archive.each("present", probes_, &ProbeStep::present);
  archive.each("turns", probes_, &ProbeStep::turns);
  archive.each("devices", probes_, &ProbeStep::device);
  archive.each("device_orientations", probes_, &ProbeStep::device_orientation);
  archive.each("orientations", probes_, &ProbeStep::orientation);
  archive.each("proxies", proxies_, &Proxy::position);
  archive.each("proxy_turns", proxies_, &Proxy::turn);
  archive("energies", energies_);
}

void ClothObjective::pack(const Field& nodes, Vector& x) const {
  packFree(nodes, x);
  forPresent([&](int k) {
    const int at = proxyAt(probes_[k]);
    x.segment<3>(at) = probes_[k].proxy;
    if (probes_[k].turns) x.segment<3>(at + 3).setZero();
  });
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
  forPresent([&](int k) {
    const int at = proxyAt(probes_[k]);
    proxies[k].position = values.segment<3>(at);
    if (probes_[k].turns) proxies[k].turn = values.segment<3>(at + 3);
  });
  mesh_.interpolateGhosts(nodes);
}

Motion ClothObjective::motion() const {
  return {mass_.data(), moving_mass_.data(), {gravity_.x(), gravity_.y(), gravity_.z()},
          inertia(),    start_.arrays(),     inertial_.arrays()};
}

double ClothObjective::evaluate(const Vector& x, Vector& gradient) {
  unpack(x, nodes_, proxies_);
  placeProbes();
  placeHeld(proxies_, nodes_);
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
  for (auto* list : {&hold_forces_, &hold_torques_}) std::fill(list->begin(), list->end(), Vec3::Zero());
  for (const HeldNode& held : held_) {
    hold_forces_[held.probe] -= gradient_[held.node];
    hold_torques_[held.probe] -= held.offset.cross(gradient_[held.node]);
    gradient_.set(held.node, Vec3::Zero());
  }
  double value = 0.0;
  forPresent([&](int k) {
    const int at = proxyAt(probes_[k]);
    gradient.segment<3>(at) = proxyGradient(k);
    if (probes_[k].turns) gradient.segment<3>(at + 3) = turnGradient(k);
    value += couplingEnergy(k) + couplingLoss(k);
  });
  return value;
}

void ClothObjective::forcesAtRest(Field& forces) const {
  forces = gradient_;
  for (int n = 0; n < mesh_.free; ++n)
    forces.add(n, moving_mass_[n] * inertia() * (inertial_[n] - start_[n]));
}

void ClothObjective::placeHeld(const Proxies& proxies, Field& nodes) const {
  if (held_.empty()) return;
  for (const HeldNode& held : held_) nodes.set(held.node, proxies[held.probe].position + held.offset);
  mesh_.interpolateGhosts(nodes);
}

void ClothObjective::moveHeld(const Proxies& directions, Field& motion) const {
  if (held_.empty()) return;
  for (const HeldNode& held : held_) {
    const Proxy& moves = directions[held.probe];
    motion.set(held.node, moves.position + moves.turn.cross(held.offset));
  }
  mesh_.interpolateGhosts(motion);
}

/// Places the probes and turns them with what they hold.
void ClothObjective::placeProbes() {
  forPresent([this](int k) {
    contacts_.placeProbe(k, proxies_[k].position);
    if (!probes_[k].turns) return;
    const Mat3 turned = rotationBy(proxies_[k].turn).toRotationMatrix();
    contacts_.turnProbe(k, turned);
    for (HeldNode& held : held_) {
      if (held.probe == k) held.offset = turned * held.start;
    }
  });
}

/// Velocity of a proxy that goes to a place, minus that of its device [m/s].
Vec3 ClothObjective::slip(int probe, const Vec3& proxy) const {
  return (proxy - probes_[probe].proxy) / timeStep() - probes_[probe].device_velocity;
}

/// Angular velocity of the proxy minus that of its device; zero if its turn is not solved for [rad/s].
Vec3 ClothObjective::turnSlip(int probe) const {
  if (!probes_[probe].turns) return Vec3::Zero();
  return (proxies_[probe].turn - probes_[probe].device_turn) / timeStep();
}

double ClothObjective::turnStiffness(int probe) const {
  const Coupling& coupling = couplings_[probe];
  return coupling.square * (coupling.stiffness * turnSpring(probe).slope() + coupling.damping / timeStep());
}

Quat ClothObjective::orientation(int probe) const {
  return rotationBy(proxies_[probe].turn) * probes_[probe].orientation;
}

Vec3 ClothObjective::couplingTorque(int probe) const {
  const Coupling& coupling = couplings_[probe];
  return coupling.square *
         (coupling.damping * turnSlip(probe) - coupling.stiffness * turnSpring(probe).torque());
}

/// Gradient of Φ by the turn of a proxy [N·m].
Vec3 ClothObjective::turnGradient(int probe) const {
  const Coupling& coupling = couplings_[probe];
  const Vec3 spring = coupling.square * coupling.stiffness * turnSpring(probe).torque();
  return coupling.square * coupling.damping * turnSlip(probe) -
         spinPerTurn(proxies_[probe].turn).transpose() * (spring + torque(probe));
}

Vec3 ClothObjective::couplingGradient(int probe, const Vec3& proxy) const {
  const Coupling& coupling = couplings_[probe];
  return coupling.stiffness * (proxy - probes_[probe].device) + coupling.damping * slip(probe, proxy);
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
  forPresent([this](int k) {
    if (probes_[k].turns) proxy_motions_[k].turn = spinPerTurn(proxies_[k].turn) * proxy_motions_[k].turn;
  });
  moveHeld(proxy_motions_, motion_);
}

/// Largest factor of the direction in proxy_motions_, up to `most`, that turns no probe too far at once.
double ClothObjective::turnLimit(double most) const {
  forPresent([&](int k) {
    const double turn = proxy_motions_[k].turn.norm();
    if (turn * most > couplings_[k].most_turn) most = couplings_[k].most_turn / turn;
  });
  return most;
}

Objective::Along ClothObjective::along(const Vector& d, double slope) {
  setMotion(d);
  const double form = formAlongMotion(false, true).sum(), step = newtonStep(slope, form);
  return {form, limitsSteps() ? contacts_.maxStep(nodes_, motion_, proxy_motions_, turnLimit(step)) : step};
}

bool ClothObjective::keepClear(Vector& d, double step) {
  detour_.clear(mesh_.nodes());
  if (!contacts_.keepClear(nodes_, motion_, step, detour_)) return false;
  mesh_.handOverGhosts(detour_, 1.0);
  for (const HeldNode& held : held_) detour_.set(held.node, Vec3::Zero());
  for (int n = 0; n < mesh_.free; ++n) {
    if (awake_.contains(n)) motion_.add(n, detour_[n]);
  }
  packFree(motion_, d);
  return true;
}

ClothObjective::QuadraticForm ClothObjective::quadraticForm(const Vector& d, bool deforms) {
  setMotion(d);
  return formAlongMotion(true, deforms);
}

double ClothObjective::maxStep(const Vector& d, double most) {
  if (!limitsSteps()) return most;
  setMotion(d);
  return contacts_.maxStep(nodes_, motion_, proxy_motions_, turnLimit(most));
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
  forPresent([&](int k) {
    const Proxy& moves = proxy_motions_[k];
    double form = couplingStiffness(k) * moves.position.squaredNorm();
    if (probes_[k].turns) form += turnStiffness(k) * moves.turn.squaredNorm();
    others += form;
  });
  return {elements[0], others};
}

void ClothObjective::fitMultilevel(bool thoroughly) {
  proxy_unknowns_.clear();
  forPresent([this](int k) {
    const ProbeStep& probe = probes_[k];
    proxy_unknowns_.push_back(
        {k, proxyAt(probe), probe.turns, couplingStiffness(k), turnStiffness(k), proxies_[k].position});
  });
  multilevel_->fit(internal_, contacts_, integrator_, awake_.flags(), nodes_, held_, proxy_unknowns_,
                   thoroughly);
}

void ClothObjective::fitPreconditioner(bool thoroughly) {
  if (multilevel_) return fitMultilevel(thoroughly);
  diagonal_.fill(0.0);
  if (preconditioner_ == Preconditioner::Jacobi) {
    blocks_.clear(mesh_.nodes());
    internal_.addBlocks(0, 1, blocks_);
    for (int n = 0; n < mesh_.nodes(); ++n) diagonal_.add(n, blocks_[n].head<3>());
    contacts_.addDiagonal(diagonal_);
    mesh_.handOverGhosts(diagonal_, 0.25);
  }
  forPresent([this](int k) {
    Vec3 shift = Vec3::Constant(couplingStiffness(k)), turn = Vec3::Constant(turnStiffness(k));
    if (preconditioner_ == Preconditioner::Jacobi) {
      shift += contacts_.proxyDiagonal(k);
      turn += contacts_.turnDiagonal(k);
    }
    for (const HeldNode& held : held_) {
      if (held.probe != k) continue;
      const Vec3 spring = diagonal_[held.node].array() + mesh_.mass[held.node] * inertia(held.node);
      shift += spring;
      turn += aroundArm((Block() << spring, Vec3::Zero()).finished(), held.offset).diagonal();
    }
    const int at = proxyAt(probes_[k]);
    inverse_diagonal_.segment<3>(at) = shift.cwiseInverse();
    if (probes_[k].turns) inverse_diagonal_.segment<3>(at + 3) = turn.cwiseInverse();
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

double ClothObjective::layerEnergy() const { return energies_[kLayers]; }

double ClothObjective::frictionPotential() const { return energies_[kFriction]; }

Vec3 ClothObjective::proxyGradient(int probe) const {
  return couplingGradient(probe, proxies_[probe].position) + contacts_.proxyGradient(probe) -
         hold_forces_[probe];
}

double ClothObjective::couplingEnergy(int probe) const {
  const ProbeStep& step = probes_[probe];
  const Coupling& coupling = couplings_[probe];
  const double shift = 0.5 * (proxies_[probe].position - step.device).squaredNorm();
  return coupling.stiffness * (step.turns ? shift + coupling.square * turnSpring(probe).energy() : shift);
}

/// Potential of the damper of a coupling [J].
double ClothObjective::couplingLoss(int probe) const {
  const Coupling& coupling = couplings_[probe];
  const double square =
      slip(probe, proxies_[probe].position).squaredNorm() + coupling.square * turnSlip(probe).squaredNorm();
  return 0.5 * coupling.damping * timeStep() * square;
}

double ClothObjective::couplingEnergy() const {
  double energy = 0.0;
  forPresent([&](int k) { energy += couplingEnergy(k); });
  return energy;
}

/// Potential of friction and coupling dampers [J].
double ClothObjective::lossPotential() const {
  double loss = energies_[kFriction];
  forPresent([&](int k) { loss += couplingLoss(k); });
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
