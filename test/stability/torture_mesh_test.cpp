/// Mesh and state in hard cases: pins where coarse cells have no particle, random splits and merges
/// in every step, all particles in one point, options and inputs that change in every step.
/// Criteria: those of every case (test/support/torture.h).
#include <gtest/gtest.h>

#include <cmath>
#include <random>

#include "support/scene_text.h"
#include "support/tolerance.h"
#include "support/torture.h"
#include "tools/run.h"

namespace haptic_cloth::torture_mesh_test {
namespace {

Torture heldSheet(const std::string& name, const std::string& fabric, int levels) {
  Torture sheet = tortureSheet(name, fabric, 17, 17, 0.1, 0.1);
  setStrategy(sheet.scene, Strategy::Amrc, levels);
  sheet.scene.cloth.pins = {{0, 0, 0, 0}, {16, 16, 0, 0}};
  sheet.scene.adapt.interval = 1;
  sheet.scene.adapt.minimum_age = 0;
  return sheet;
}

/// Random numbers that depend only on the step, so that every run of a case has the same.
double random(long step, int which) {
  std::mt19937 generator(static_cast<unsigned>(7919 * step + 104729 * which + 1));
  return std::uniform_real_distribution<double>()(generator);
}

/// Options with which all cells that may split or merge do so, or those that a random threshold
/// picks.
AdaptOptions randomThresholds(AdaptOptions options, long step) {
  const double turn = std::pow(10.0, -4.0 + 4.0 * random(step, 0));
  options.strategy = random(step, 1) < 0.5 ? Strategy::Refine : Strategy::Coarsen;
  options.refine_above = turn;
  options.coarsen_below = 100.0 * turn;
  options.refine_above_strain = 0.1 * turn;
  options.coarsen_below_strain = 10.0 * turn;
  return options;
}

TEST(Torture, RefinedAndCoarsenedAtRandomInEveryStep) {
  for (const bool suiting : {false, true}) {
    Torture sheet = heldSheet(suiting ? "random_mesh_suiting" : "random_mesh",
                              suiting ? shippedFabric("winter_suiting") : lightFabric(), 3);
    sheet.scene.probes[0].path = {{0.0, Vec3(0, 0, 0.03)}, {0.2, Vec3(0, 0, -0.03)}, {0.3, Vec3(0, 0, 0.05)}};
    sheet.scene.stop.time = 0.3;
    sheet.before = [&](ClothWorld& world, long step) {
      world.setAdaptOptions(randomThresholds(world.scene().adapt, step));
    };
    torture(sheet);
  }
}

/// The ends of a strip come together in 1 s by a tenth of its length, nearly without weight. It buckles in
/// short waves, which merge into one. A merge that turned them into compressed chords would create up to a
/// third of the energy turned over.
TEST(Torture, StripThatBucklesWithHardlyAnyWeight) {
  for (const Integrator integrator : {Integrator::Euler, Integrator::Bdf2}) {
    constexpr double kLength = 0.2, kSpeed = 0.01;
    LinearFabric linear;
    linear.stiffness = 2500.0;
    linear.rigidity = 5e-5;
    linear.compression = 0.8;
    Torture strip = tortureSheet(integrator == Integrator::Euler ? "buckles" : "buckles_bdf2",
                                 writeFabric(linear), 41, 9, kLength, kLength / 5.0);
    setStrategy(strip.scene, Strategy::Amrc, 3);
    strip.scene.cloth.pins = {{0, 0, 0, 8}, {40, 40, 0, 8}};
    strip.scene.cloth.pins[0].velocity = Vec3(kSpeed, 0.0, 0.0);
    strip.scene.cloth.pins[1].velocity = Vec3(-kSpeed, 0.0, 0.0);
    strip.scene.gravity = Vec3(0.0, 0.0, -0.1);
    strip.scene.air_damping = 20.0;
    strip.scene.solver.integrator = integrator;
    strip.scene.stop.time = 1.0;
    torture(strip);
  }
}

TEST(Torture, PinsWhereCoarseCellsHaveNoParticle) {
  // Pins on sides and inside of the coarsest cells, on all three finer levels.
  for (const Strategy strategy : {Strategy::Coarsest, Strategy::Amrc}) {
    Torture sheet = heldSheet("pins_on_ghosts_" + name(strategy), lightFabric(), 3);
    sheet.scene.adapt.strategy = strategy;
    sheet.scene.cloth.pins = {{4, 4, 8, 8}, {12, 12, 6, 6}, {9, 9, 15, 15}, {13, 13, 11, 11}, {3, 5, 1, 1}};
    sheet.scene.stop.time = 0.3;
    torture(sheet);
  }
}

constexpr double kFoldedApart = 1e-3;  // distance of the sides of a fold: twice the thickness [m]

/// Degenerate initial positions: in one point, nearly so, on a line, folded, mirrored.
Vec3 collapsed(const std::string& kind, const Vec3& x) {
  if (kind == "all_at_a_point") return Vec3::Zero();
  if (kind == "all_near_a_point") return 1e-9 * x;
  if (kind == "shrunk_1e6") return 1e-6 * x;
  if (kind == "shrunk_1e3") return 1e-3 * x;
  if (kind == "all_on_a_line") return {x.x(), 0.0, 0.0};
  if (kind == "folded_flat") return {std::abs(x.x()), x.y(), 0.0};
  if (kind == "folded_apart") return {std::abs(x.x()), x.y(), x.x() < 0.0 ? kFoldedApart : 0.0};
  return {-x.x(), x.y(), 0.0};
}

/// Velocity of the mass centre [m/s].
Vec3 meanVelocity(const ClothWorld& world) {
  const ActiveMesh& mesh = world.cloth().mesh();
  Vec3 momentum = Vec3::Zero();
  for (int n = 0; n < mesh.active(); ++n)
    momentum += mesh.mass[n] * world.cloth().state().velocity[mesh.particle[n]];
  return momentum / world.cloth().mass();
}

/// Radius of gyration of the cloth over that of the flat sheet [-].
double relativeSize(const ClothWorld& world) {
  const ActiveMesh& mesh = world.cloth().mesh();
  const Grid& grid = world.cloth().grid();
  Vec3 centre = Vec3::Zero();
  for (int n = 0; n < mesh.active(); ++n)
    centre += mesh.mass[n] / world.cloth().mass() * world.cloth().nodes()[n];
  double now = 0.0, flat = 0.0;
  for (int n = 0; n < mesh.active(); ++n) {
    const double u = (grid.column(mesh.particle[n]) - 0.5 * (grid.columns - 1)) * grid.dx,
                 v = (grid.row(mesh.particle[n]) - 0.5 * (grid.rows - 1)) * grid.dy;
    now += mesh.mass[n] * (world.cloth().nodes()[n] - centre).squaredNorm();
    flat += mesh.mass[n] * (u * u + v * v);
  }
  return std::sqrt(now / flat);
}

/// Expects the mass centre to fall like a free particle under backward Euler, v ← (v + g h)/(1 + c
/// h), because inner forces have no resultant. A step that ends at its tolerance may leave a net
/// force of tolerance · |g| · mass, as |Σ r| ≤ rms_m(r/m) · mass [Cauchy and Schwarz]; a step that
/// was cut short leaves no more. @param scale of all velocities by the energy guard
void expectFreeFall(const ClothWorld& world, const Vec3& before, long step) {
  const SolverOptions& solver = world.scene().solver;
  const double h = solver.time_step, g = world.scene().gravity.norm();
  const Vec3 fallen = (before + h * world.scene().gravity) / (1.0 + world.scene().air_damping * h);
  EXPECT_LE((meanVelocity(world) - fallen).norm(), tolerance(solver.minimizer.tolerance * g * h))
      << world.scene().cloth.fabric.name << ", step " << step;
}

/// Free sheet with collapsed positions at the first step.
Torture collapsedSheet(const std::string& kind) {
  Torture sheet = tortureSheet(kind, lightFabric(), 9, 9, 0.1, 0.1);
  // The positions are set before the mesh refines for the first time and reads the state again.
  setStrategy(sheet.scene, Strategy::Refine, 1);
  sheet.scene.adapt.interval = 1;
  sheet.scene.adapt.coarsen_below = 0.0;
  sheet.scene.stop.time = 0.06;
  sheet.set_up = 1;
  if (kind != "folded_apart") sheet.limits.crossed = "all parts begin at one place, or through each other";
  // Cloth without area has no normals. They turn while it unfolds, and may make all of its energy again; the
  // guard takes it from the motion.
  if (kind.rfind("all_", 0) == 0) sheet.limits.turned = 1.0;
  // Its parts are at one place, where no layers can be, and it opens through itself.
  if (kind == "folded_flat" || kind == "all_on_a_line") sheet.scene.cloth.self_contact = false;
  sheet.before = [kind](ClothWorld& world, long step) {
    if (step != 0) return;
    std::vector<Vec3> positions = world.cloth().state().position;
    for (Vec3& x : positions) x = collapsed(kind, x);
    world.setPositions(positions);
    AdaptOptions options = world.scene().adapt;
    options.refine_above_strain = options.refine_above = -1.0;
    world.setAdaptOptions(options);
  };
  return sheet;
}

TEST(Torture, ParticlesAllAtOnePoint) {
  for (const std::string kind :
       {"all_at_a_point", "all_near_a_point", "all_on_a_line", "folded_flat", "folded_apart", "mirrored"}) {
    SCOPED_TRACE(kind);
    Torture sheet = collapsedSheet(kind);
    // No edge can be shorter than a point. The energy that this stores, E/20 per area and
    // direction, gives a stretch of √0.1, or twice that in a quarter of the sheet.
    sheet.limits.strain = 1.0 + 1e-9;
    Vec3 velocity;
    sheet.after = [&velocity, &sheet](const ClothWorld& world, long step) {
      if (step >= sheet.set_up) expectFreeFall(world, velocity, step);
      velocity = meanVelocity(world);
    };
    torture(sheet);
  }
}

TEST(Torture, ShrunkClothFallsFreelyWhileItUnfolds) {
  // Nothing but gravity, which is in the balance, does work on it: its energy may only fall. Round-off is
  // that of Torture's balance.
  for (const std::string kind : {"shrunk_1e6", "shrunk_1e3"}) {
    SCOPED_TRACE(kind);
    const Torture sheet = collapsedSheet(kind);
    ClothWorld world(sheet.scene);
    Vec3 velocity = Vec3::Zero();
    double dissipated = 0.0, turned_over = 0.0;
    const long steps = std::lround(sheet.scene.stop.time / sheet.scene.solver.time_step);
    for (long step = 0; step < steps; ++step) {
      sheet.before(world, step);
      const StepReport report = world.step();
      EXPECT_FALSE(report.failed) << "step " << step;
      if (step >= sheet.set_up) expectFreeFall(world, velocity, step);
      velocity = meanVelocity(world);
      const EnergyReport energy = world.energy();
      if (step < sheet.set_up) turned_over = energy.stretch + energy.bend + energy.shear;
      if (step > sheet.set_up) {
        EXPECT_GE(energy.dissipated, dissipated - tolerance(1e-10 * turned_over));
      }
      dissipated = energy.dissipated;
    }
    // It began at a thousandth of its size or less, and stays crumpled: 0.2 to 0.7 in 32 runs whose starts
    // differed by rounding. The largest strain of a crumpled sheet, 0.01 to 0.6 in these, says less.
    EXPECT_GT(relativeSize(world), 0.1) << "it did not unfold";
  }
}

TEST(Torture, EverythingChangesInEveryStep) {
  // Devices appear, vanish, close, open and jump, an obstacle is thrown about, and thresholds
  // change.
  Torture sheet = heldSheet("all_inputs_random", shippedFabric("winter_suiting"), 3);
  Obstacle ball;
  ball.name = "ball";
  ball.shape = Shape::Sphere;
  ball.radius = 0.03;
  ball.pose.position = Vec3(0.0, 0.0, -0.08);
  sheet.scene.obstacles = {ball};
  sheet.scene.probes.resize(2);
  sheet.scene.probes[1].name = "second";
  sheet.scene.stop.time = 0.15;
  // Length of an edge between a pin and the farthest position of the ball, 0.1 m to each side;
  // nothing else limits it.
  sheet.limits.strain = Vec3(0.18, 0.18, 0.13).norm() / (0.1 / 16.0);
  sheet.limits.any_speed = "devices and ball at 110 m/s explain any";
  sheet.before = [](ClothWorld& world, long step) {
    const auto at = [step](int first, double reach) {
      return Vec3(reach * (random(step, first) - 0.5), reach * (random(step, first + 1) - 0.5),
                  reach * (random(step, first + 2) - 0.5));
    };
    world.setAdaptOptions(randomThresholds(world.scene().adapt, step));
    world.moveObstacle(0, {at(10, 0.2), Quat::Identity()});
    for (int k = 0; k < 2; ++k) {
      const double what = random(step / 10, 20 + k);
      if (what < 0.2) {
        world.removeDevice(k);
      } else {
        world.setDevice(k, {at(30 + 3 * k, 0.1), at(40 + 3 * k, 1.0), Quat::Identity()});
        world.setGrasp(k, what < 0.5);
      }
    }
  };
  torture(sheet);
}

TEST(Torture, SavedSceneReplaysTheSameBits) {
  // A failed case must leave files that reproduce it.
  Torture sheet = heldSheet("replay", shippedFabric("winter_suiting"), 2);
  hangDown(sheet.scene);
  Obstacle box;
  box.shape = Shape::Box;
  box.name = "box";
  box.size = Vec3(0.1, 0.07, 0.03);
  box.pose.position = Vec3(0.06, 0.0, -0.05);
  box.path = {{0.0, box.pose.position}, {0.1, Vec3(0.02, 0.0, -0.05)}};
  sheet.scene.obstacles = {box};
  ProbeOptions finger = gripper(0.03, 500.0);
  finger.path = {{0.0, Vec3(-0.02, 0.0, 0.0)}, {0.1, Vec3(0.01, 0.0, 1.0 / 3.0)}};
  finger.grasp = {{0.02, 0.05}, {0.07, 0.08}};
  sheet.scene.probes = {finger};
  sheet.scene.stop.time = 0.1;
  const std::string directory = testing::TempDir() + "haptic_cloth_replay";
  const Scene read = loadScene(saveTorture(sheet, directory));
  const Scene again = loadScene(saveTorture({sheet.name, sheet.fabric_file, read, {}}, directory));
  EXPECT_EQ(sceneText(read, "f.yaml"), sceneText(again, "f.yaml"));
  std::vector<Vec3> seen, replayed;
  sheet.scene = read;
  sheet.after = [&](const ClothWorld& world, long) { seen = world.cloth().state().position; };
  torture(sheet);
  Simulation simulation(again);
  runScene(simulation, Rows::None, nullptr);
  simulation.positions(replayed);
  std::vector<char> active;
  simulation.activeFlags(active);
  ASSERT_EQ(seen.size(), replayed.size());
  for (std::size_t p = 0; p < seen.size(); ++p) {
    if (active[p] == 0) continue;
    EXPECT_EQ(seen[p], replayed[p]) << p;
  }
}

}  // namespace
}  // namespace haptic_cloth::torture_mesh_test
