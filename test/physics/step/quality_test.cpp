/// Steps of other lengths and lower quality under a hand.
/// Criteria: at rest a change of either changes the force by at most 2 % from one step to the next while the
/// mesh near the probe stays, and in all by less than a hand can tell, 5 to 7 % (docs/model.md). Forces are
/// 0.1 N and more: below, 2 % are less than the 2 mN to which the shape of the cloth far away fixes the
/// force.
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <functional>
#include <utility>
#include <vector>

#include "haptic_cloth/haptic_session.h"
#include "haptics/quality_ladder.h"
#include "support/record.h"
#include "support/scenes.h"
#include "support/tolerance.h"

namespace haptic_cloth::quality_test {
namespace {

constexpr double kAtOnce = 0.02, kInAll = 0.05;  // of the force

/// A probe comes down on the edge of a box under a drape, and stays.
Scene touchedDrape(Integrator integrator) {
  Scene scene = boxDrape(33);
  scene.cloth.fabric = loadFabric(HAPTIC_CLOTH_SOURCE_DIR "/config/fabrics/winter_suiting.yaml");
  scene.solver.integrator = integrator;
  scene.solver.sleep_speed = 0.0;  // steps that are not taken would pass
  scene.probes[0].radius = 0.008;
  scene.probes[0].path = {{0.8, Vec3(0.06, 0.0, 0.02)}, {0.9, Vec3(0.06, 0.0, 0.002)}};
  return scene;
}

/// A probe presses into a sheet that is held on all sides and sags by 8 mm.
/// @param target of the probe's centre [m]
Scene pressedSheet(Integrator integrator, const Vec3& target) {
  Scene scene = touchedDrape(integrator);
  scene.obstacles.clear();
  scene.cloth.size = {0.2, 0.2};
  pinAllSides(scene);
  scene.air_damping = 5.0;
  scene.probes[0].path = {{0.0, Vec3(target.x(), target.y(), 0.01)}, {0.3, target}};
  return scene;
}

/// A probe presses into a sheet that hangs at its corners: folds along the diagonals carry the load.
Scene hangingSheet(Integrator integrator, const std::string& fabric) {
  Scene scene = touchedDrape(integrator);
  scene.obstacles.clear();
  scene.cloth.fabric = loadFabric(HAPTIC_CLOTH_SOURCE_DIR "/config/fabrics/" + fabric + ".yaml");
  for (const int j : {0, scene.cloth.particles[1] - 1}) {
    for (const int i : {0, scene.cloth.particles[0] - 1}) pin(scene, i, i, j, j);
  }
  scene.air_damping = 5.0;
  scene.probes[0].radius = 0.02;
  scene.probes[0].path = {{0.0, Vec3(0.03, 0.02, 0.022)}, {0.4, Vec3(0.03, 0.02, -0.04)}};
  return scene;
}

void step(Simulation& simulation, int length) {
  followPaths(simulation, length);
  simulation.step(length);
}

/// Takes steps with each length, and compares the force with that before the last change.
/// @param name of the change, for the record @param at_once limit from one step to the next [-]
void expectSameForce(const std::string& name, double at_once, Simulation& simulation,
                     const std::vector<int>& lengths, const std::function<void(std::size_t)>& change) {
  double largest = 0.0;
  for (std::size_t k = 0; k < lengths.size(); ++k) {
    const Vec3 usual = simulation.probe().force;
    ASSERT_GT(usual.norm(), 0.1);
    change(k);
    double most = 0.0, most_at_once = 0.0;
    for (int n = 0; n < 30; ++n) {
      const Vec3 before = simulation.probe().force;
      step(simulation, lengths[k]);
      const Vec3 now = simulation.probe().force;
      most = std::max(most, (now - usual).norm() / usual.norm());
      most_at_once = std::max(most_at_once, (now - before).norm() / usual.norm());
    }
    EXPECT_LE(most_at_once, tolerance(at_once)) << "change " << k;
    EXPECT_LE(most, tolerance(kInAll)) << "change " << k;
    largest = std::max(largest, most_at_once);
  }
  record({name, "largest change of the force from one step to the next [%]", "amrc", 0.0, 100.0 * largest,
          0.0, 100.0 * at_once});
}

struct Case {
  std::string name;
  Scene scene;
};

void PrintTo(const Case& test_case, std::ostream* out) { *out << test_case.name; }

class QualityAtRest : public testing::TestWithParam<Case> {
 protected:
  QualityAtRest() : simulation_(GetParam().scene) {
    while (simulation_.time() < 1.5) step(simulation_, 1);
  }
  Simulation simulation_;
};

TEST_P(QualityAtRest, TheLengthOfAStepIsNotFelt) {
  expectSameForce("steps of other lengths, " + GetParam().name, kAtOnce, simulation_, {2, 4, 8, 4, 2, 1},
                  [](std::size_t) {});
}

/// Goes down the rungs of a ladder and up again.
void expectSameForceOnRungs(const std::string& name, double at_once, Simulation& simulation,
                            std::vector<Quality> rungs) {
  const Scene scene = simulation.scene();
  for (std::size_t k = rungs.size() - 1; k-- > 0;) rungs.push_back(rungs[k]);
  std::vector<int> lengths;
  for (const Quality& rung : rungs) lengths.push_back(rung.longest_step);
  expectSameForce(name, at_once, simulation, lengths, [&](std::size_t k) {
    simulation.setOptions(rungs[k].solver, rungs[k].adapt, scene.air_damping);
  });
}

void expectSameForceOnRungsThatKeepTheMesh(const std::string& name, Simulation& simulation) {
  const Scene scene = simulation.scene();
  std::vector<Quality> rungs = qualityLadder(scene.solver, scene.adapt, 4);
  const auto shrinks = [&](const Quality& rung) { return rung.adapt.near_reach < scene.adapt.near_reach; };
  rungs.erase(std::find_if(rungs.begin(), rungs.end(), shrinks), rungs.end());
  ASSERT_EQ(rungs.size(), 5U);
  expectSameForceOnRungs("rungs that keep the mesh of a hand, " + name, kAtOnce, simulation, rungs);
}

TEST_P(QualityAtRest, ARungThatKeepsTheMeshOfAHandIsNotFelt) {
  expectSameForceOnRungsThatKeepTheMesh(GetParam().name, simulation_);
}

/// The last rungs take cells near the probe, too, and miss kAtOnce
/// (docs/decisions/0042-a-hand-keeps-its-mesh.md). A hand cannot tell them yet.
TEST_P(QualityAtRest, TheLastRungsAreHardlyFelt) {
  const Scene scene = simulation_.scene();
  expectSameForceOnRungs("all rungs, " + GetParam().name, kInAll, simulation_,
                         qualityLadder(scene.solver, scene.adapt, 4));
}

INSTANTIATE_TEST_SUITE_P(
    Scenes, QualityAtRest,
    testing::Values(Case{"drape", touchedDrape(Integrator::Euler)},
                    Case{"drape_bdf2", touchedDrape(Integrator::Bdf2)},
                    Case{"sheet", pressedSheet(Integrator::Euler, {0.0, 0.0, -0.007})},
                    Case{"sheet_bdf2", pressedSheet(Integrator::Bdf2, {0.0, 0.0, -0.007})},
                    Case{"light", pressedSheet(Integrator::Euler, {0.0, 0.0, -0.0055})},
                    Case{"aside", pressedSheet(Integrator::Bdf2, {0.03, 0.017, -0.0055})},
                    Case{"deep", pressedSheet(Integrator::Bdf2, {0.0, 0.0, -0.009})},
                    Case{"deep_aside", pressedSheet(Integrator::Euler, {0.03, 0.017, -0.009})}),
    [](const auto& info) { return info.param.name; });

/// Cells that carry the load of the probe keep their mesh, however far they are.
class QualityUnderLoad : public QualityAtRest {};

TEST_P(QualityUnderLoad, ARungThatKeepsTheMeshOfAHandIsNotFelt) {
  expectSameForceOnRungsThatKeepTheMesh(GetParam().name, simulation_);
}

INSTANTIATE_TEST_SUITE_P(Scenes, QualityUnderLoad,
                         testing::Values(Case{"suiting", hangingSheet(Integrator::Euler, "winter_suiting")},
                                         Case{"wool_bdf2", hangingSheet(Integrator::Bdf2, "wool_tropical")},
                                         Case{"faille", hangingSheet(Integrator::Euler, "polyester_faille")}),
                         [](const auto& info) { return info.param.name; });

/// Force on the probe of a scene at the end of each step that all rungs make. @param length [time steps]
std::vector<Vec3> forcesAlongPath(Simulation simulation, int length) {
  constexpr int kEvery = 4;  // [time steps]
  std::vector<Vec3> forces;
  const Scene& scene = simulation.scene();
  for (int k = length; k * scene.solver.time_step < scene.stop.time * (1.0 + 1e-9); k += length) {
    step(simulation, length);
    if (k % kEvery == 0) forces.push_back(simulation.probe().force);
  }
  return forces;
}

/// The same with options of one of its rungs, in its longest steps.
std::vector<Vec3> forcesOnRung(const Scene& scene, const Quality& rung) {
  Simulation simulation(scene);
  simulation.setOptions(rung.solver, rung.adapt, scene.air_damping);
  return forcesAlongPath(std::move(simulation), rung.longest_step);
}

/// The same on the finest mesh, converged.
std::vector<Vec3> exactForcesAlongPath(Scene scene) {
  scene.adapt.strategy = Strategy::Finest;
  scene.solver.minimizer.tolerance = 0.01;
  scene.solver.minimizer.max_iterations = 2000;
  return forcesAlongPath(Simulation(scene), 1);
}

/// A probe pushes a strip into a fold. Criterion: the table in docs/guide/speed_and_accuracy.md, root mean
/// square on three paths of vector code: 3 % down to 20 iterations, 7 % with 10, and 12 to 28 % in steps of 4
/// ms. Solves that a limit ends depend on the order of sums: about half as much again is allowed for.
TEST(Rungs, CostTheForceOfAFoldWhatTheGuideSays) {
  const Scene scene = loadScene(HAPTIC_CLOTH_SOURCE_DIR "/bench/scenes/fold_probe.yaml");
  const std::vector<Vec3> expected = exactForcesAlongPath(scene);
  double mean = 0.0;
  for (const Vec3& force : expected) mean += force.squaredNorm();
  const std::vector<Quality> rungs = qualityLadder(scene.solver, scene.adapt, 4);
  ASSERT_EQ(rungs.size(), 10U);
  for (std::size_t r = 0; r < rungs.size(); ++r) {
    const std::vector<Vec3> found = forcesOnRung(scene, rungs[r]);
    ASSERT_EQ(found.size(), expected.size());
    double squared = 0.0;
    for (std::size_t k = 0; k < found.size(); ++k) squared += (found[k] - expected[k]).squaredNorm();
    const int iterations = rungs[r].solver.minimizer.max_iterations;
    const bool cut = iterations < kManyIterations;
    const double limit = !cut                        ? 0.03
                         : rungs[r].longest_step > 2 ? 0.4
                         : iterations <= 10          ? 0.11
                                                     : 0.05,
                 error = std::sqrt(squared / mean);
    record({"rungs of the ladder, a probe pushes a strip into a fold", "rms error of the force [%]", "amrc",
            static_cast<double>(r), 100.0 * error, 0.0, 100.0 * limit});
    EXPECT_LT(error, tolerance(limit)) << rungs[r].given_up;
  }
}

/// A light sheet that hangs from two corners, and a hand that sweeps through it at 0.45 m/s.
Scene sweptSheet() {
  Scene scene;
  scene.cloth.fabric = loadFabric(HAPTIC_CLOTH_SOURCE_DIR "/config/fabrics/polyester_faille.yaml");
  scene.cloth.particles = {33, 33};
  scene.cloth.size = {0.2, 0.2};
  scene.cloth.pose.position = Vec3::Zero();
  scene.cloth.pose.orientation = Quat(Eigen::AngleAxisd(M_PI / 2, Vec3::UnitX()));
  for (const int i : {0, 32}) pin(scene, i, i, 32, 32);
  scene.solver.threads = 1;
  scene.probes[0].radius = 0.008;
  scene.probes[0].path = {{0.1, Vec3(0.02, 0.06, -0.03)}, {0.5, Vec3(0.02, -0.12, -0.03)}};
  scene.stop.time = 0.5;
  return scene;
}

/// A hand sweeps at 0.45 m/s through a light sheet that hangs from two corners. On all rungs that do not cut
/// iterations it has to feel hardly more than the exact peak, 0.04 N: half as much again is allowed for, as
/// above. The next one, which cuts them to 20, may cost up to 0.2 N on the three paths, says the guide; with
/// steps of 4 ms it was 2.3 N.
TEST(Rungs, LeaveAHandThatSweepsThroughLightClothItsForce) {
  const Scene scene = sweptSheet();
  const auto peak = [](const std::vector<Vec3>& forces) {
    double most = 0.0;
    for (const Vec3& force : forces) most = std::max(most, force.norm());
    return most;
  };
  const double expected = peak(exactForcesAlongPath(scene));
  const std::vector<Quality> rungs = qualityLadder(scene.solver, scene.adapt, 4);
  for (std::size_t r = 0; r < rungs.size(); ++r) {
    const double found = peak(forcesOnRung(scene, rungs[r]));
    record({"rungs of the ladder, a probe sweeps through a sheet", "largest force [N]", "amrc",
            static_cast<double>(r), found, expected, expected});
    const int iterations = rungs[r].solver.minimizer.max_iterations;
    if (iterations < 20) continue;
    EXPECT_LT(found, tolerance(1.5) * (iterations == 20 ? 0.2 : expected)) << rungs[r].given_up;
  }
}

/// Largest force that a session lets a hand feel on the path of a scene, on one of its rungs, whose steps
/// come in time [N].
double feltOnRung(const Scene& scene, const Quality& rung) {
  constexpr double kTick = 1e-3, kStart = 10.0;  // [s]
  Simulation simulation(scene);
  simulation.setOptions(rung.solver, rung.adapt, scene.air_damping);
  HapticOptions options;
  options.soft_start = 0.0;
  HapticSession session(simulation.scene(), 0, options);
  double most = 0.0;
  for (int k = 1; k * kTick < scene.stop.time; ++k) {
    const double now = kStart + k * kTick;
    const Pose pose{pathPosition(scene.probes[0].path, k * kTick), Quat::Identity()};
    most = std::max(most, session.tick(pose, now).force.norm());
    if (k % rung.longest_step != 0) continue;
    session.beforeStep(simulation, now, rung.longest_step);
    simulation.step(rung.longest_step);
    session.afterStep(simulation, now);
  }
  return most;
}

/// The last rung computes forces of up to 4 N there, which are 0.04 N. A hand that felt them would be at the
/// limit of its device, 3.3 N. Criterion: the largest on three paths of vector code
/// (docs/decisions/0046-forces-below-their-error.md), 0.5 N, with half as much again for solves that a limit
/// ends. The rung before it, 1.2 to 1.9 N there (2.5 N if all is passed on), is only recorded.
TEST(Rungs, KeepForcesBelowTheirErrorFromTheHand) {
  const Scene scene = sweptSheet();
  const std::vector<Quality> rungs = qualityLadder(scene.solver, scene.adapt, 4);
  for (std::size_t r = 0; r < rungs.size(); ++r) {
    const double felt = feltOnRung(scene, rungs[r]);
    record({"rungs of the ladder, a probe sweeps through a sheet", "largest force felt [N]", "amrc",
            static_cast<double>(r), felt, 0.04, 0.04});
    if (r != 8) {
      EXPECT_LT(felt, tolerance(1.5 * 0.5)) << rungs[r].given_up;
    }
  }
}

}  // namespace
}  // namespace haptic_cloth::quality_test
