#include "haptic_cloth/simulation.h"

#include <algorithm>
#include <cmath>
#include <cstring>
#include <new>
#include <sstream>

#include "contact/crossings.h"
#include "haptic_cloth/error.h"
#include "haptic_cloth/machine.h"
#include "scene/scene_options.h"
#include "scene/scene_validation.h"
#include "sim/cloth_world.h"
#include "sim/recording.h"
#include "state/byte_hash.h"

namespace haptic_cloth {
namespace {

/// Refuses a change of a row that is not live.
/// @param now, changed by value, as rows point to members that could be written
void requireFixed(StepOptions now, StepOptions changed) {
  const Options rows = optionsOf(now), next = optionsOf(changed);
  for (std::size_t k = 0; k < rows.size(); ++k) {
    if (rows[k].live || valueText(rows[k]) == valueText(next[k])) continue;
    throw InputError("options", rows[k].key, "", "cannot change while the simulation runs");
  }
}

/// Refuses a number that is not one of the scene's probes or obstacles.
void requireNumber(const char* kind, int number, std::size_t count) {
  if (number >= 0 && number < static_cast<int>(count)) return;
  throw InputError("simulation", kind, std::to_string(number),
                   std::string("must be one of the scene's, which has ") + std::to_string(count));
}

/// Tells whether a pose is within the limits of the simulation. Numbers that are not finite are not.
bool isUsable(const Vec3& position, const Quat& orientation) {
  const double norm = orientation.norm();
  return position.norm() < kFarthestPose && norm > 0.0 && std::isfinite(norm);
}

/// Refuses cloth that passes through itself. Self-contact keeps layers on the sides where they are, so it
/// would never come apart.
/// @param origin source of the cloth in messages
void requireNoCrossings(const Cloth& cloth, const std::string& origin) {
  const Crossings found = findCrossings(cloth.mesh(), cloth.nodes());
  if (found.pairs == 0) return;
  std::ostringstream place;
  place << found.pairs << " crossings, first of cells (" << found.cell[0] << ", " << found.cell[1]
        << ") and (" << found.other[0] << ", " << found.other[1] << ") at [" << found.position.x() << ", "
        << found.position.y() << ", " << found.position.z() << "] m";
  throw InputError(origin, "cloth", place.str(),
                   "must not pass through itself with cloth.self_contact, which cannot untangle it");
}

}  // namespace

void Simulation::requireProbe(int probe) const { requireNumber("probe", probe, scene().probes.size()); }
void Simulation::requireObstacle(int obstacle) const {
  requireNumber("obstacle", obstacle, scene().obstacles.size());
}

Simulation::Simulation(const Scene& scene) {
  validateScene(scene, "scene");
  // Throws if HAPTIC_CLOTH_SIMD names no usable set, before any kernel runs.
  instructionSet();
  try {
    world_ = std::make_unique<ClothWorld>(scene);
  } catch (const std::bad_alloc&) {
    const auto& [columns, rows] = scene.cloth.particles;
    throw InputError("scene", "cloth.particles", std::to_string(columns) + " x " + std::to_string(rows),
                     "needs more memory than there is");
  }
}

Simulation::~Simulation() = default;
Simulation::Simulation(Simulation&&) noexcept = default;
Simulation& Simulation::operator=(Simulation&&) noexcept = default;

void Simulation::setDevice(int probe, const DeviceState& device) {
  requireProbe(probe);
  const bool usable = isUsable(device.position, device.orientation) &&
                      device.velocity.norm() < kFarthestPose && std::isfinite(device.elapsed);
  if (!usable) return;
  if (sink_) sink_(recorded::device(probe, device));
  world_->setDevice(probe, device);
}

void Simulation::removeDevice(int probe) {
  requireProbe(probe);
  if (sink_) sink_(recorded::removal(probe));
  world_->removeDevice(probe);
}

void Simulation::setGrasp(int probe, bool closed) {
  requireProbe(probe);
  if (sink_ && closed != world_->isClosed(probe)) sink_(recorded::grasp(probe, closed));
  world_->setGrasp(probe, closed);
}

void Simulation::moveObstacle(int obstacle, const Pose& pose) {
  requireObstacle(obstacle);
  if (!isUsable(pose.position, pose.orientation)) return;
  if (sink_) sink_(recorded::obstacle(obstacle, pose));
  world_->moveObstacle(obstacle, {pose.position, pose.orientation.normalized()});
}

Pose Simulation::obstaclePose(int obstacle) const {
  requireObstacle(obstacle);
  const Solid& solid = world_->contacts().obstacle(obstacle);
  return {solid.position(), Quat(solid.rotation())};
}

void Simulation::setOptions(const SolverOptions& solver, const AdaptOptions& adapt, double air_damping) {
  const StepOptions now = stepOptions(scene()), changed{solver, adapt, air_damping};
  requireFixed(now, changed);
  checkStepOptions(changed, "options");
  if (sink_) sink_(recorded::options(now, changed));
  world_->setOptions(solver, adapt, air_damping);
}

void Simulation::setCoupling(int probe, double stiffness, double damping) {
  requireProbe(probe);
  const ProbeOptions& now = world_->scene().probes[probe];
  if (stiffness == now.coupling_stiffness && damping == now.coupling_damping) return;
  checkOptions(couplingOptions(stiffness, damping), "probe.", [](const std::string&) { return "options"; });
  if (sink_) sink_(recorded::coupling(probe, stiffness, damping));
  world_->setCoupling(probe, stiffness, damping);
}

StepReport Simulation::step(int length) {
  length = std::max(1, length);
  if (sink_) sink_(recorded::step(length));
  return world_->step(length);
}

void Simulation::reset() {
  if (sink_) sink_(recorded::reset());
  world_ = std::make_unique<ClothWorld>(Scene(scene()));
}

std::string Simulation::saveState() const {
  Archive archive;
  world_->serialize(archive);
  return archive.sealed();
}

void Simulation::loadState(const std::string& saved, const std::string& origin) {
  Archive archive(saved, origin);
  auto loaded = std::make_unique<ClothWorld>(Scene(scene()));
  loaded->serialize(archive);
  archive.finish();
  if (loaded->contacts().meetsItself()) requireNoCrossings(loaded->cloth(), origin);
  record(nullptr);
  world_ = std::move(loaded);
}

void Simulation::record(Sink sink) {
  const Sink ended = std::exchange(sink_, nullptr);  // a sink that throws takes no more lines
  if (ended) ended(recorded::end(*this));
  if (!sink) return;
  for (const std::string& line : recorded::header(*this)) sink(line);
  sink_ = std::move(sink);
}

const Scene& Simulation::scene() const { return world_->scene(); }
double Simulation::time() const { return world_->time(); }
int Simulation::threads() const { return world_->threads(); }
double Simulation::mass() const { return world_->cloth().mass(); }
int Simulation::activeParticles() const { return world_->cloth().mesh().active(); }
bool Simulation::meetsItself() const { return world_->contacts().meetsItself(); }
ProbeReport Simulation::probe(int probe) const {
  requireProbe(probe);
  return world_->probes()[probe];
}

EnergyReport Simulation::energy() const { return world_->energy(); }
double Simulation::maxSpeed() const { return world_->cloth().maxSpeed(); }
Vec3 Simulation::supportForce() const { return world_->supportForce(); }

CostReport Simulation::cost() const { return world_->cost(); }

double Simulation::maxStrain() const {
  const Cloth& cloth = world_->cloth();
  return cloth.internal().maxStrain(cloth.nodes());
}

std::uint64_t Simulation::stateHash() const {
  ByteHash hash;
  const ParticleState& state = world_->cloth().state();
  for (const int p : world_->cloth().mesh().particle) {
    hash.add(&p, sizeof(p));
    hash.add(state.position[p].data(), 3 * sizeof(double));
    hash.add(state.velocity[p].data(), 3 * sizeof(double));
  }
  for (const ProbeReport& probe : world_->probes()) {
    hash.add(probe.proxy.data(), 3 * sizeof(double));
    hash.add(probe.orientation.coeffs().data(), 4 * sizeof(double));
  }
  const long ticks = world_->ticks();
  hash.add(&ticks, sizeof(ticks));
  return hash.value();
}

void Simulation::positions(std::vector<Vec3>& positions) const {
  const Cloth& cloth = world_->cloth();
  positions = cloth.state().position;
  for (const Patch& patch : cloth.mesh().patches) {
    if (patch.cell.level > 0) interpolateCell(cloth.grid(), patch.cell, positions);
  }
}

Crossings Simulation::crossings() const {
  const Cloth& cloth = world_->cloth();
  return findCrossings(cloth.mesh(), cloth.nodes());
}

void Simulation::activeFlags(std::vector<char>& flags) const {
  const ActiveMesh& mesh = world_->cloth().mesh();
  flags.assign(mesh.grid.particles(), 0);
  for (int n = 0; n < mesh.active(); ++n) flags[mesh.particle[n]] = 1;
}

void Simulation::cells(std::vector<CellView>& cells) const {
  const ActiveMesh& mesh = world_->cloth().mesh();
  cells.clear();
  for (const Patch& patch : mesh.patches) {
    cells.push_back({patch.cell.corners(mesh.grid), patch.cell.level, patch.cell.diagonalRises()});
  }
}

void Simulation::cellLoads(std::vector<float>& tension, std::vector<float>& bending) const {
  const Cloth& cloth = world_->cloth();
  const ActiveMesh& mesh = cloth.mesh();
  std::vector<double> node_tension(mesh.nodes(), 0.0), node_bending(mesh.nodes(), 0.0);
  for (int e = 0; e < static_cast<int>(mesh.edges.size()); ++e) {
    const double value = cloth.internal().tension(e, cloth.nodes());
    for (const int n : {mesh.edges[e].a, mesh.edges[e].b}) node_tension[n] = std::max(node_tension[n], value);
  }
  for (int t = 0; t < static_cast<int>(mesh.triples.size()); ++t) {
    double& largest = node_bending[mesh.triples[t].c];
    largest = std::max(largest, cloth.internal().bendingDensity(t, cloth.nodes()));
  }
  tension.clear();
  bending.clear();
  for (const Patch& patch : mesh.patches) {
    const auto most = [&](const std::vector<double>& values) {
      double largest = 0.0;
      for (const int n : patch.nodes) largest = std::max(largest, values[n]);
      return static_cast<float>(largest);
    };
    tension.push_back(most(node_tension));
    bending.push_back(most(node_bending));
  }
}

}  // namespace haptic_cloth
