#include "support/state_cases.h"

#include <algorithm>
#include <cmath>
#include <cstring>

#include "state/byte_hash.h"
#include "support/scenes.h"

namespace haptic_cloth {
namespace {

constexpr double kStep = 1e-3;  ///< time step of all cases [s]

/// Fabric with memory in tension, bending and shear, and with twist.
Fabric richFabric() {
  Fabric fabric = loadFabric(HAPTIC_CLOTH_SOURCE_DIR "/config/fabrics/winter_suiting.yaml");
  fabric.twist_rigidity = 1e-5;
  return fabric;
}

/// Square with cells of 5 mm, held on all sides.
Scene heldSheet(int particles, Strategy strategy) {
  const double size = 0.005 * (particles - 1);
  Scene scene = sheetScene(richFabric(), particles, particles, size, size);
  pinAllSides(scene);
  setStrategy(scene, strategy, 2);
  scene.adapt.minimum_age = 9;
  scene.probes[0].radius = 0.008;
  scene.air_damping = 2.0;
  return scene;
}

/// A capsule comes down, slides and turns, and the mesh follows it.
Scene capsuleScene(int particles, Strategy strategy) {
  Scene scene = heldSheet(particles, strategy);
  scene.probes[0].length = 0.01;
  scene.probes[0].friction = 0.4;
  scene.adapt.coarsen_below = 0.5;
  scene.adapt.refine_above_strain = 0.01;
  scene.adapt.coarsen_below_strain = 0.008;
  return scene;
}

void driveCapsule(Simulation& simulation, int step) {
  if (step >= 71 && step < 74) return;  // no input
  const double t = step * kStep, down = std::min(t, 0.04), slid = std::max(0.0, t - 0.04);
  const Vec3 position(-0.015 + 0.3 * slid, 0.1 * slid, 0.014 - 0.4 * down), velocity(0.3, 0.1, 0.0);
  const Quat turn(Eigen::AngleAxisd(8.0 * t, Vec3(1.0, 2.0, 1.0).normalized()));
  simulation.setDevice(0, {position, velocity, turn});
}

StateCase slidingCapsule() {
  return {"a sliding capsule",
          capsuleScene(17, Strategy::Amrc),
          driveCapsule,
          120,
          {1, 37, 50, 71, 90},
          [](const Exercised& did) { return did.touched > 50 && did.refined > 0 && did.coarsened > 0; }};
}

StateCase secondOrder() {
  StateCase run = slidingCapsule();
  run.name = "a sliding capsule that leaves, BDF2, steps of varying length at last";
  run.scene.solver.integrator = Integrator::Bdf2;
  run.drive = [](Simulation& simulation, int step) {
    if (step < 80) return driveCapsule(simulation, step);
    simulation.removeDevice(0);
  };
  run.length = [](int step) { return step < 85 ? 1 : 1 + step % 3; };
  run.saves = {1, 37, 50, 82, 90};
  run.exercises = [](const Exercised& did) { return did.touched > 30 && did.refined > 0; };
  return run;
}

/// The hand slides while solves are cut short, then rests while they converge: what they left unbalanced
/// still counts in the estimated error of the force.
StateCase hastySlide() {
  StateCase run = slidingCapsule();
  run.name = "a sliding capsule, solves cut short";
  run.scene.solver.minimizer.max_iterations = 4;
  run.drive = [](Simulation& simulation, int step) {
    if (step < 60) driveCapsule(simulation, step);
  };
  run.saves = {75};
  run.exercises = [](const Exercised& did) { return did.touched > 50; };
  return run;
}

StateCase jointCost() {
  Scene scene = capsuleScene(9, Strategy::Refine);
  scene.solver.cost = Cost::Joint;
  scene.solver.minimizer.max_iterations = 30;
  return {"joint cost", scene,   driveCapsule,
          50,           {1, 30}, [](const Exercised& did) {
            return did.touched > 20 && did.refined > 0; }};
}

/// Two probes: one grasps, lifts, turns, first as fast as its device and then as fast as a hand, and
/// releases; the other appears inside the cloth and is removed later.
StateCase graspedSheet() {
  Scene scene = sheetScene(richFabric(), 17, 17, 0.08, 0.08);
  setStrategy(scene, Strategy::Amrc, 2);
  scene.adapt.minimum_age = 9;
  pin(scene, 0, 0, 0, 16);
  scene.probes.resize(2);
  scene.probes[0].name = "thumb";
  scene.probes[1].name = "index";
  const auto drive = [](Simulation& simulation, int step) {
    const double t = step * kStep, down = std::min(t, 0.03), lifted = std::max(0.0, t - 0.05);
    const double turned = (step < 100 ? 0.0 : 2.0) + 10.0 * lifted;  // [rad]
    simulation.setDevice(1, {Vec3(0.02, 0.0, 0.012 - 0.4 * down + 0.3 * lifted), Vec3(0.0, 0.0, 0.1),
                             Quat(Eigen::AngleAxisd(turned, Vec3(0.6, 0.0, 0.8)))});
    if (step == 30) simulation.setGrasp(1, true);
    if (step == 110) simulation.setGrasp(1, false);
    if (step == 5) simulation.setDevice(0, {Vec3(-0.02, 0.01, 0.0), Vec3(0.0, 0.05, 0.0)});
    if (step == 60) simulation.setDevice(0, {Vec3(-0.02, 0.01, -0.02), Vec3::Zero()});
    if (step == 125) simulation.removeDevice(0);
  };
  return {"a grasp", scene, drive, 140, {6, 31, 33, 105, 126}, [](const Exercised& did) {
            return did.held > 20 && did.ignored > 5;
          }};
}

/// A box is sent through a hanging cloth, farther than it may move in a step, and turned.
StateCase movedObstacles() {
  Scene scene = boxDrape(17);
  scene.cloth.fabric = richFabric();
  scene.obstacles[0].name = "box";
  Obstacle ball;
  ball.shape = Shape::Sphere;
  ball.radius = 0.02;
  ball.pose.position = Vec3(0.05, 0.0, 0.05);
  scene.obstacles.push_back(ball);
  const auto drive = [](Simulation& simulation, int step) {
    const Quat turn(Eigen::AngleAxisd(0.7, Vec3::UnitZ()));
    if (step == 20) simulation.moveObstacle(0, {Vec3(0.05, 0.02, -0.03), turn});
    if (step >= 60) simulation.moveObstacle(1, {Vec3(0.05, 0.0, 0.05 - 2e-4 * (step - 60)), turn});
  };
  return {"moving obstacles",
          scene,
          drive,
          120,
          {21, 60, 90},
          [](const Exercised& did) {
            return did.moved > 50; }};
}

/// Comes to rest, skips steps, and wakes: first by an obstacle that moves without touching it, then
/// by a probe that pushes a corner. The probe is so slow that the far side sleeps for about 20 more
/// steps, however the numbers are rounded.
StateCase sleepingSheet() {
  Scene scene = heldSheet(33, Strategy::Finest);
  scene.air_damping = 30.0;
  scene.solver.sleep_speed = 5e-3;
  scene.probes[0].radius = 0.004;
  Obstacle far;
  far.shape = Shape::Sphere;
  far.radius = 0.05;
  far.pose.position = Vec3(0.0, 0.0, 1.0);
  scene.obstacles = {far};
  const auto drive = [](Simulation& simulation, int step) {
    const Quat turn(Eigen::AngleAxisd(0.1, Vec3::UnitX()));
    if (step == 395) simulation.removeDevice(0);
    if (step == 0) simulation.setDevice(0, {Vec3(-0.06, -0.06, 0.008), Vec3::Zero()});
    if (step == 310) simulation.moveObstacle(0, {Vec3(0.0, 0.0, 1.005), Quat::Identity()});
    if (step == 330) simulation.moveObstacle(0, {Vec3(0.0, 0.0, 1.0), turn});
    if (step == 311 || step == 331) simulation.moveObstacle(0, {Vec3(0.0, 0.0, 1.0), Quat::Identity()});
    if (step <= 460) return;
    const double way = 1e-4 * (step - 460), fast = std::min(way, 4.75e-3), slow = 0.03 * (way - fast);
    simulation.setDevice(
        0, {Vec3(-0.06, -0.06, 0.008 - fast - slow), Vec3(0.0, 0.0, slow > 0.0 ? -0.003 : -0.1)});
  };
  return {"sleep", scene, drive, 540, {60, 200, 300, 312, 332, 455, 525}, [](const Exercised& did) {
            return did.idle > 10 && did.asleep > 10 && did.touched > 10;
          }};
}

/// Cloth that is held inside a floor, below a capsule that stays: steps are skipped.
StateCase heldInside() {
  Scene scene = sheetScene(richFabric(), 5, 5, 0.02, 0.02);
  pin(scene, 0, 4, 0, 4);
  scene.cloth.pose.position.z() = -0.001;
  Obstacle floor;
  floor.shape = Shape::Plane;
  scene.obstacles = {floor};
  scene.probes[0].radius = 0.004;
  scene.probes[0].length = 0.004;
  const auto drive = [](Simulation& simulation, int step) {
    if (step == 0) simulation.setDevice(0, {Vec3(0.0, 0.0, 0.02), Vec3::Zero()});
  };
  return {
      "held inside a floor", scene, drive, 130, {120}, [](const Exercised& did) {
            return did.idle > 10; }};
}

/// Hangs by its corners from the coarsest mesh, which splits under its weight while it is still
/// flat.
StateCase coarseHammock() {
  Scene scene = sheetScene(richFabric(), 17, 17, 0.3, 0.3);
  setStrategy(scene, Strategy::Amrc, 4);
  scene.adapt.start = StartMesh::Coarsest;
  for (const int i : {0, 16}) {
    for (const int j : {0, 16}) pin(scene, i, i, j, j);
  }
  const auto drive = [](Simulation&, int) {};
  return {"a coarse hammock", scene, drive, 40, {3}, [](const Exercised& did) { return did.refined > 0; }};
}

/// A flat sheet whose thresholds are lower for a decision. They return between two decisions, and at the next
/// one cells of any age merge.
StateCase returningThresholds(const std::string& name, double AdaptOptions::*threshold) {
  Scene scene = sheetScene(richFabric(), 9, 9, 0.08, 0.08);
  scene.gravity = Vec3::Zero();
  scene.solver.sleep_speed = 0.0;
  setStrategy(scene, Strategy::Amrc, 2);
  scene.adapt.interval = 3;
  scene.adapt.minimum_age = 1000;
  const auto drive = [scene, threshold](Simulation& simulation, int step) {
    AdaptOptions adapt = scene.adapt;
    if (step < 4) adapt.*threshold *= 0.5;
    if (step == 1 || step == 4) simulation.setOptions(scene.solver, adapt, scene.air_damping);
  };
  constexpr int kAtFirst = 16;  // 8 x 8 cells become 4 x 4, before the thresholds change
  return {name, scene, drive, 10, {5}, [](const Exercised& did) { return did.coarsened > kAtFirst; }};
}

/// The hems of a sheet are driven against each other by their pins, which stop there; the cloth between
/// hangs in folds.
StateCase pressedLayers() {
  Scene scene = sheetScene(richFabric(), 17, 5, 0.08, 0.02);
  setStrategy(scene, Strategy::Amrc, 2);
  scene.adapt.minimum_age = 9;
  pin(scene, 0, 0, 0, 4);
  pin(scene, 16, 16, 0, 4);
  scene.cloth.pins[0].velocity = Vec3(0.4, 0.0, 0.0);
  scene.cloth.pins[1].velocity = Vec3(-0.4, 0.0, 0.0);
  const auto drive = [](Simulation&, int) {};
  return {"layers that press", scene, drive, 180, {97, 103, 120, 126}, [](const Exercised& did) {
            return did.pressed > 50 && did.refined > 0;
          }};
}

class Hash {
 public:
  void add(const void* data, std::size_t size) { bytes_.add(data, size); }
  template <class T>
  void add(const std::vector<T>& values) {
    add(values.data(), values.size() * sizeof(T));
  }
  void add(double value) { add(&value, sizeof(value)); }
  void add(const Vec3& value) { add(value.data(), 3 * sizeof(double)); }
  std::uint64_t value() const { return bytes_.value(); }

 private:
  ByteHash bytes_;
};

void add(Hash& hash, const EnergyReport& energy) {
  for (const double part : {energy.kinetic, energy.gravity, energy.stretch, energy.bend, energy.shear,
                            energy.contact, energy.coupling, energy.work, energy.dissipated}) {
    hash.add(part);
  }
}

}  // namespace

/// A hanging strip is wound up by its first columns.
StateCase rolledStrip() {
  Scene scene = sheetScene(richFabric(), 33, 9, 0.12, 0.03);
  setStrategy(scene, Strategy::Amrc, 2);
  hangDown(scene);
  pin(scene, 0, 2, 0, 8);
  scene.cloth.pins[0].turn = Vec3(0.0, 100.0, 0.0);
  scene.cloth.pins[0].centre = Vec3(0.0, 0.0, 0.06 - 0.12 / 32.0);
  return {"a strip that is rolled up",
          scene,
          [](Simulation&, int) {},
          160,
          {100, 130},
          [](const Exercised& did) { return did.pressed > 20; }};
}

std::vector<StateCase> stateCases() {
  return {slidingCapsule(),
          secondOrder(),
          hastySlide(),
          jointCost(),
          graspedSheet(),
          movedObstacles(),
          sleepingSheet(),
          heldInside(),
          coarseHammock(),
          pressedLayers(),
          rolledStrip(),
          returningThresholds("angles that return", &AdaptOptions::coarsen_below),
          returningThresholds("strains that return", &AdaptOptions::coarsen_below_strain)};
}

std::uint64_t readings(const Simulation& simulation) {
  Hash hash;
  std::vector<Vec3> positions;
  std::vector<CellView> cells;
  std::vector<float> tension, bending;
  simulation.positions(positions);
  simulation.cells(cells);
  simulation.cellLoads(tension, bending);
  hash.add(positions);
  for (const CellView& cell : cells) {
    hash.add(cell.particles.data(), sizeof(cell.particles));
    hash.add(2.0 * cell.level + cell.diagonal_rises);
  }
  hash.add(tension);
  hash.add(bending);
  add(hash, simulation.energy());
  for (std::size_t k = 0; k < simulation.scene().probes.size(); ++k) {
    const ProbeReport probe = simulation.probe(static_cast<int>(k));
    for (const Vec3& vector :
         {probe.device, probe.proxy, probe.velocity, probe.force, probe.torque, probe.way_out})
      hash.add(vector);
    hash.add(probe.force_error);
    hash.add(probe.turn_radius);
    hash.add(probe.orientation.coeffs().data(), 4 * sizeof(double));
    hash.add(8.0 * probe.present + 4.0 * probe.contact + 2.0 * probe.grasps + probe.inside);
  }
  for (std::size_t k = 0; k < simulation.scene().obstacles.size(); ++k) {
    const Pose pose = simulation.obstaclePose(static_cast<int>(k));
    hash.add(pose.position);
    hash.add(pose.orientation.coeffs().data(), 4 * sizeof(double));
  }
  const CostReport cost = simulation.cost();
  for (const double value : {cost.motion, cost.stretch, cost.bend, cost.shear, simulation.maxSpeed(),
                             simulation.maxStrain(), simulation.time(), simulation.mass()}) {
    hash.add(value);
  }
  hash.add(simulation.supportForce());
  return hash.value();
}

std::uint64_t readings(const Simulation& simulation, const StepReport& report) {
  Hash hash;
  hash.add(static_cast<double>(readings(simulation) >> 11));
  const MinimizerReport& solve = report.minimizer;
  for (const double value :
       {report.time, double(report.active_particles), double(report.awake_particles), double(report.refined),
        double(report.coarsened), double(report.failed), report.velocity_scale, report.max_penetration,
        double(report.self_contacts), report.min_self_gap, solve.motion_made, double(solve.why),
        double(solve.iterations), double(solve.evaluations), double(solve.restarts), solve.value_start,
        solve.value_end, solve.residual}) {
    hash.add(value);
  }
  return hash.value();
}

std::uint64_t advance(const StateCase& run, Simulation& simulation, int step, Exercised* exercised) {
  const auto obstacles = [&] {
    std::vector<Vec3> places;
    for (std::size_t k = 0; k < run.scene.obstacles.size(); ++k) {
      places.push_back(simulation.obstaclePose(static_cast<int>(k)).position);
    }
    return places;
  };
  const std::vector<Vec3> before = obstacles();
  run.drive(simulation, step);
  const StepReport report = simulation.step(run.length ? run.length(step) : 1);
  if (exercised != nullptr) {
    exercised->refined += report.refined;
    exercised->coarsened += report.coarsened;
    exercised->idle += report.minimizer.evaluations == 0;
    exercised->most_awake = std::max(exercised->most_awake, report.awake_particles);
    exercised->asleep += report.awake_particles > 0 && report.awake_particles < exercised->most_awake;
    exercised->moved += before != obstacles();
    exercised->pressed += report.self_contacts > 0;
    for (std::size_t k = 0; k < run.scene.probes.size(); ++k) {
      const ProbeReport probe = simulation.probe(static_cast<int>(k));
      exercised->touched += probe.contact;
      exercised->held += probe.grasps;
      exercised->ignored += probe.present && !probe.contact && std::abs(probe.proxy.z()) < 0.005;
    }
  }
  return readings(simulation, report);
}

namespace {

constexpr char kMagic[] = "haptic_cloth state\n";
/// Size of the header: magic, byte order, version, size, checksum.
constexpr std::size_t kHeader = sizeof(kMagic) - 1 + 24;

template <class T>
T take(const std::string& bytes, std::size_t& at) {
  T value;
  std::memcpy(&value, bytes.data() + at, sizeof(T));
  at += sizeof(T);
  return value;
}

template <class T>
void put(std::string& bytes, T value) {
  bytes.append(reinterpret_cast<const char*>(&value), sizeof(T));
}

std::size_t sizeOf(char type) { return type == 'b' ? 1 : type == 'i' ? 4 : 8; }

}  // namespace

std::vector<StateEntry> stateEntries(const std::string& sealed) {
  std::vector<StateEntry> entries;
  for (std::size_t at = kHeader; at < sealed.size();) {
    StateEntry entry;
    const auto length = take<std::uint32_t>(sealed, at);
    entry.name = sealed.substr(at, length);
    at += length;
    entry.type = take<char>(sealed, at);
    const auto count = take<std::uint64_t>(sealed, at);
    entry.bytes = sealed.substr(at, count * sizeOf(entry.type));
    at += entry.bytes.size();
    entries.push_back(entry);
  }
  return entries;
}

void foldThrough(std::vector<StateEntry>& entries, double width, double height) {
  const auto find = [&](const std::string& name) -> std::string& {
    return std::find_if(entries.begin(), entries.end(), [&](const auto& e) { return e.name == name; })->bytes;
  };
  std::string &xs = find("nodes.x"), &zs = find("nodes.z");
  for (std::size_t at = 0; at < xs.size(); at += sizeof(double)) {
    double x, z;
    std::memcpy(&x, &xs[at], sizeof x);
    std::memcpy(&z, &zs[at], sizeof z);
    if (x >= 0.0) continue;
    x = -x;
    z += (3.0 - 8.0 * x / width) * height;
    std::memcpy(&xs[at], &x, sizeof x);
    std::memcpy(&zs[at], &z, sizeof z);
  }
}

std::string sealState(const std::vector<StateEntry>& entries) {
  std::string content;
  for (const StateEntry& entry : entries) {
    put(content, static_cast<std::uint32_t>(entry.name.size()));
    content += entry.name;
    put(content, entry.type);
    put(content, static_cast<std::uint64_t>(entry.bytes.size() / sizeOf(entry.type)));
    content += entry.bytes;
  }
  Hash hash;
  hash.add(content.data(), content.size());
  std::string sealed = kMagic;
  put(sealed, std::uint32_t{0x01020304});
  put(sealed, std::uint32_t{17});
  put(sealed, static_cast<std::uint64_t>(content.size()));
  put(sealed, hash.value());
  return sealed + content;
}

}  // namespace haptic_cloth
