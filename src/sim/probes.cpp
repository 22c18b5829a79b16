#include "sim/probes.h"

#include <algorithm>
#include <cmath>
#include <optional>
#include <utility>

#include "sim/cloth_objective.h"
#include "sim/force_error.h"
#include "sim/grasps.h"

namespace haptic_cloth {

namespace {

/// Largest turn of an open sphere in a step [rad].
constexpr double kLargestTurn = 0.25;

/// Turns by at most `most` [rad] towards an orientation.
Quat towards(const Quat& from, const Quat& to, double most) {
  const double angle = from.angularDistance(to);
  return angle > most ? Quat(from.slerp(most / angle, to)) : to;
}

Vec3 smaller(const Vec3& a, const Vec3& b) { return a.squaredNorm() <= b.squaredNorm() ? a : b; }

}  // namespace

Probes::Probes(const Scene& scene)
    : scene_(scene),
      steps_(scene.probes.size()),
      memories_(scene.probes.size()),
      reports_(scene.probes.size()) {
  touching_.reserve(count());
}

bool Probes::jumps(int k, const DeviceState& device, double time_step) const {
  const ProbeStep& step = steps_[k];
  const double elapsed = std::max(device.elapsed, time_step);
  const double turn = device.orientation.normalized().angularDistance(step.device_orientation);
  return step.present && (isJump((device.position - step.device).norm(), elapsed) ||
                          (!isOpenSphere(k) && isTurnJump(turn, elapsed)));
}

void Probes::setClosed(int k, bool closed) { memories_[k].closed = closed; }

void Probes::setDevice(int k, const DeviceState& device) {
  ProbeStep& step = steps_[k];
  Memory& memory = memories_[k];
  step.device_orientation = device.orientation.normalized();
  if (!step.present) {
    step.proxy = device.position;
    reports_[k].proxy = device.position;
    reports_[k].velocity = Vec3::Zero();
    memory.coupled.device = device.position;
    memory.coupled.orientation = step.orientation = reports_[k].orientation = step.device_orientation;
    memory.spin.setZero();
    memory.has_been_clear = false;
  }
  step.present = true;
  step.device = device.position;
  step.device_velocity = device.velocity;
  reports_[k].present = true;
  reports_[k].device = device.position;
}

void Probes::remove(int k) {
  steps_[k] = ProbeStep();
  reports_[k] = ProbeReport();
}

void Probes::beginStep(double time_step) {
  for (int k = 0; k < count(); ++k) {
    ProbeStep& step = steps_[k];
    Memory& memory = memories_[k];
    const bool turned = std::exchange(step.turns, !isOpenSphere(k) && scene_.solver.cost == Cost::Condensed);
    if (step.turns && !turned) memory.coupled.orientation = step.device_orientation;  // the coupling begins
    step.device_turn = turnBetween(memory.coupled.orientation, step.device_orientation);
    step.prescribed = step.orientation;
    if (isOpenSphere(k))
      step.prescribed = towards(step.orientation, step.device_orientation,
                                std::min(kFastestTurn * time_step, kLargestTurn));
  }
}

double Probes::fastestTurn() const {
  double fastest = 0.0;
  for (int k = 0; k < count(); ++k) {
    if (steps_[k].present)
      fastest = std::max(fastest, std::sqrt(turnRadiusSquared(scene_.probes[k])) * spin(k).norm());
  }
  return fastest;
}

bool Probes::turnsAsPrescribed(int k) const {
  const ProbeStep& step = steps_[k];
  return step.present && isOpenSphere(k) && step.device_orientation.coeffs() != step.orientation.coeffs();
}

const std::vector<ContactSet::Reach>& Probes::findTouching(const ActiveMesh& mesh, const Field& nodes,
                                                           const std::vector<double>& reach,
                                                           ContactSet& contacts) {
  touching_.clear();
  for (int k = 0; k < count(); ++k) {
    Memory& memory = memories_[k];
    if (!steps_[k].present) continue;
    contacts.startProbe(k, steps_[k].proxy, steps_[k].orientation, steps_[k].prescribed,
                        reports_[k].velocity);
    if (!memory.has_been_clear) {
      const std::optional<Vec3> way_out = contacts.wayOut(mesh, nodes, k);
      memory.has_been_clear = !way_out;
      reports_[k].way_out = way_out.value_or(Vec3::Zero());
    }
    if (memory.has_been_clear) touching_.push_back({k, reach[k]});
  }
  return touching_;
}

void Probes::accept(const ClothObjective& solved, const ContactSet& contacts, const ActiveMesh& mesh,
                    const Grasps& grasps, ForceError& error) {
  for (int k = 0; k < count(); ++k) {
    if (!steps_[k].present) continue;
    ProbeReport& report = reports_[k];
    report.proxy = solved.proxy(k);
    const Vec3 moved = report.proxy - steps_[k].proxy;
    report.velocity = moved / solved.timeStep();
    report.grasps = grasps.holds(k);
    Vec3 force = solved.force(k), torque = solved.torque(k);
    // Where what it holds is jammed, a solve that is cut short leaves forces that no hand exerts.
    if (report.grasps) {
      force = smaller(force, solved.couplingForce(k));
      if (steps_[k].turns) torque = smaller(torque, solved.couplingTorque(k));
    }
    const bool felt = !report.force.isZero(0.0) || !force.isZero(0.0);
    const double unbalanced = felt ? error.unbalancedForce(k, solved, mesh) : 0.0;
    report.force_error = error.estimate(k, moved.norm(), unbalanced, report.force, force);
    report.force = force;
    report.torque = torque;
    report.contact = report.grasps || contacts.probeTouched(k);
    report.inside = !memories_[k].has_been_clear;
    report.orientation = steps_[k].turns ? Quat(solved.orientation(k).normalized()) : steps_[k].prescribed;
    memories_[k].spin = solved.turn(k) / solved.timeStep();
    report.turn_radius = steps_[k].turns ? std::sqrt(turnRadiusSquared(scene_.probes[k])) : 0.0;
    steps_[k].proxy = report.proxy;
    steps_[k].orientation = report.orientation;
  }
}

void Probes::restore() {
  for (Memory& memory : memories_) memory.spin.setZero();
  for (ProbeReport& report : reports_) {
    report.velocity = Vec3::Zero();
    report.force_error = std::max(report.force_error, report.force.norm());
    report.force = report.torque = Vec3::Zero();
    report.contact = false;
  }
}

Probes::Coupled Probes::replaceCoupling(int k, double energy) {
  return std::exchange(memories_[k].coupled, {steps_[k].device, steps_[k].device_orientation, energy});
}

void Probes::serialize(Archive& archive) {
  archive("probe", steps_);
  archive("probe_memory", memories_);
  archive.each("probe_present", reports_, &ProbeReport::present);
  archive.each("probe_device", reports_, &ProbeReport::device);
  archive.each("probe_proxy", reports_, &ProbeReport::proxy);
  archive.each("probe_velocity", reports_, &ProbeReport::velocity);
  archive.each("probe_force", reports_, &ProbeReport::force);
  archive.each("probe_force_error", reports_, &ProbeReport::force_error);
  archive.each("probe_torque", reports_, &ProbeReport::torque);
  archive.each("probe_contact", reports_, &ProbeReport::contact);
  archive.each("probe_grasps", reports_, &ProbeReport::grasps);
  archive.each("probe_inside", reports_, &ProbeReport::inside);
  archive.each("probe_way_out", reports_, &ProbeReport::way_out);
  archive.each("probe_orientation", reports_, &ProbeReport::orientation);
  archive.each("probe_turn_radius", reports_, &ProbeReport::turn_radius);
}

void Probes::Memory::serialize(Archive& archive) {
  archive("entered", has_been_clear);
  archive("closed", closed);
  archive("spin", spin);
  archive("coupled_device", coupled.device);
  archive("coupled_orientation", coupled.orientation);
  archive("coupling", coupled.energy);
}

}  // namespace haptic_cloth
