#include "sim/probes.h"

#include <algorithm>
#include <utility>

#include "sim/cloth_objective.h"
#include "sim/force_error.h"
#include "sim/grasps.h"

namespace haptic_cloth {

namespace {

/// Way of the points of a probe in a step by its turn, at most, over its radius: it must not pass cloth [-].
constexpr double kShareOfRadius = 0.25;

}  // namespace

Probes::Probes(int count) : steps_(count), memories_(count), reports_(count) { touching_.reserve(count); }

bool Probes::jumps(int k, const DeviceState& device, double time_step) const {
  const double elapsed = std::max(device.elapsed, time_step);
  return steps_[k].present && isJump((device.position - steps_[k].device).norm(), elapsed);
}

void Probes::setClosed(int k, bool closed) {
  memories_[k].closed = closed;
  if (!closed) memories_[k].slip.setIdentity();
}

void Probes::setDevice(int k, const DeviceState& device) {
  ProbeStep& step = steps_[k];
  Memory& memory = memories_[k];
  memory.device = device.orientation.normalized();
  if (!step.present) {
    step.proxy = device.position;
    reports_[k].proxy = device.position;
    reports_[k].velocity = Vec3::Zero();
    memory.coupled.device = device.position;
    memory.has_been_clear = false;
    memory.before = reports_[k].orientation = memory.device;
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

void Probes::beginStep(const std::vector<ProbeOptions>& probes, double time_step) {
  for (int k = 0; k < count(); ++k) {
    const ProbeOptions& probe = probes[k];
    const double extent = probe.radius + 0.5 * probe.length;
    const double most = std::min(kFastestTurn * time_step, kShareOfRadius * probe.radius / extent);
    Memory& memory = memories_[k];
    memory.after = memory.aim();
    const double angle = memory.before.angularDistance(memory.after);
    if (angle > most) limitTurn(k, most / angle);
  }
}

void Probes::limitTurn(int k, double share) {
  Memory& memory = memories_[k];
  if (share < 1.0) memory.after = memory.before.slerp(share, memory.after);
}

bool Probes::turns(int k) const {
  return steps_[k].present && memories_[k].aim().coeffs() != memories_[k].before.coeffs();
}

const std::vector<ContactSet::Reach>& Probes::findTouching(const ActiveMesh& mesh, const Field& nodes,
                                                           const std::vector<double>& reach,
                                                           ContactSet& contacts) {
  touching_.clear();
  for (int k = 0; k < count(); ++k) {
    Memory& memory = memories_[k];
    if (!steps_[k].present) continue;
    contacts.startProbe(k, steps_[k].proxy, memory.before, memory.after);
    if (!memory.has_been_clear) memory.has_been_clear = contacts.isClear(mesh, nodes, k);
    if (memory.has_been_clear) touching_.push_back({k, reach[k]});
  }
  return touching_;
}

void Probes::accept(double made, const ClothObjective& solved, const ContactSet& contacts,
                    const ActiveMesh& mesh, const Grasps& grasps, ForceError& error) {
  for (int k = 0; k < count(); ++k) {
    if (!steps_[k].present) continue;
    ProbeReport& report = reports_[k];
    report.proxy = solved.proxy(k);
    const Vec3 moved = report.proxy - steps_[k].proxy;
    report.velocity = moved / solved.timeStep();
    const Vec3 force = solved.holdForce(k) - contacts.proxyGradient(k);
    const bool felt = !report.force.isZero(0.0) || !force.isZero(0.0);
    const double unbalanced = felt ? error.unbalancedForce(k, solved, mesh) : 0.0;
    report.force_error = error.estimate(k, moved.norm(), unbalanced, report.force, force);
    report.force = force;
    limitTurn(k, made);
    report.grasps = grasps.holds(k);
    const Vec3 torque = solved.holdTorque(k) + contacts.proxyTorque(k, solved.nodes());
    report.torque = report.grasps ? feltTorque(k, torque) : torque;
    report.contact = report.grasps || contacts.probeTouched(k);
    steps_[k].proxy = report.proxy;
    Memory& memory = memories_[k];
    if (report.grasps && memory.after.coeffs() != memory.aim().coeffs())
      memory.slip = (memory.device.conjugate() * memory.after).normalized();
    memory.before = report.orientation = memory.after;
  }
}

/// Torque on the hand of a probe that holds cloth. Where the probe turns less than its device, a torque that
/// drives the hand does as much work on it as on the probe.
Vec3 Probes::feltTorque(int k, const Vec3& torque) const {
  const Memory& memory = memories_[k];
  const Eigen::AngleAxisd asked(memory.aim() * memory.before.conjugate());
  const Eigen::AngleAxisd made(memory.after * memory.before.conjugate());
  const bool follows = made.angle() >= asked.angle(), resists = torque.dot(asked.axis()) <= 0.0;
  return follows || resists ? torque : Vec3(made.angle() / asked.angle() * torque);
}

void Probes::restore() {
  for (ProbeReport& report : reports_) {
    report.velocity = Vec3::Zero();
    report.force_error = std::max(report.force_error, report.force.norm());
    report.force = report.torque = Vec3::Zero();
    report.contact = false;
  }
}

Probes::Coupled Probes::replaceCoupling(int k, double energy) {
  return std::exchange(memories_[k].coupled, {steps_[k].device, energy});
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
  for (int k = 0; k < count(); ++k) reports_[k].orientation = memories_[k].before;
}

void Probes::Memory::serialize(Archive& archive) {
  archive("entered", has_been_clear);
  archive("closed", closed);
  archive("orientation", device);
  archive("slip", slip);
  archive("before", before);
  archive("coupled_device", coupled.device);
  archive("coupling", coupled.energy);
}

}  // namespace haptic_cloth
