/// When the mesh is decided upon. A flat sheet without gravity may merge everywhere, so the times of its
/// merges are those of the decisions. Criteria: `adapt.interval` and `adapt.minimum_age` as options.h defines
/// them, in time steps of the scene.
#include <gtest/gtest.h>

#include <vector>

#include "support/scenes.h"

namespace haptic_cloth::decision_times_test {
namespace {

constexpr int kInterval = 3, kAge = 30;  // time steps

Scene flatSheet() {
  Scene scene = sheetScene(makeFabric({}), 17, 17, 0.16, 0.16);
  scene.gravity = Vec3::Zero();
  scene.solver.sleep_speed = 0.0;
  setStrategy(scene, Strategy::Amrc, 2);
  scene.adapt.interval = kInterval;
  scene.adapt.minimum_age = kAge;
  return scene;
}

/// Simulated times, in time steps, at which steps begin in which cells merge.
std::vector<int> mergeTimes(Simulation& simulation, int length, int until) {
  std::vector<int> times;
  for (int tick = 0; tick < until; tick += length) {
    if (simulation.step(length).coarsened > 0) times.push_back(tick);
  }
  return times;
}

// Merges to level 1 begin at once, those to level 2 when level 1 is 30 time steps old: a decision falls on
// that time with all these lengths. Late solvers, which take long steps, need the coarser mesh most.
TEST(DecisionTimes, DoNotDependOnTheLengthOfSteps) {
  for (const int length : {1, 2, 3, 5, 10}) {
    Simulation simulation(flatSheet());
    EXPECT_EQ(mergeTimes(simulation, length, 60), (std::vector<int>{0, kAge})) << length;
  }
}

TEST(DecisionTimes, CellsOfAnyAgeMergeWhereThresholdsGrow) {
  Scene scene = flatSheet();
  scene.adapt.minimum_age = 1000;
  Simulation simulation(scene);
  EXPECT_EQ(mergeTimes(simulation, 1, 30), std::vector<int>{0});
  AdaptOptions adapt = scene.adapt;
  simulation.setOptions(scene.solver, adapt, scene.air_damping);  // the same options
  EXPECT_TRUE(mergeTimes(simulation, 1, 30).empty());
  adapt.coarsen_below *= 0.5;
  simulation.setOptions(scene.solver, adapt, scene.air_damping);
  EXPECT_TRUE(mergeTimes(simulation, 1, 30).empty());
  simulation.setOptions(scene.solver, scene.adapt, scene.air_damping);
  simulation.setOptions(scene.solver, adapt, scene.air_damping);  // no decision between, as around a save
  EXPECT_TRUE(mergeTimes(simulation, 1, 30).empty());
  adapt.coarsen_below *= 1.5;
  simulation.setOptions(scene.solver, adapt, scene.air_damping);
  EXPECT_EQ(mergeTimes(simulation, 1, 30), std::vector<int>{0});
}

// The age of the first cells must not bound that of a scene with a lower minimum.
TEST(DecisionTimes, AStateKeepsAgesWhereTheMinimumChanged) {
  Scene scene = flatSheet();
  Simulation simulation(scene);
  scene.adapt.minimum_age = kAge / 3;
  simulation.setOptions(scene.solver, scene.adapt, scene.air_damping);
  constexpr int kSaved = 6, kOldEnough = 12;  // the first decision at which cells are 10 time steps old
  EXPECT_EQ(mergeTimes(simulation, 1, kSaved), std::vector<int>{0});
  Simulation later(scene);
  later.loadState(simulation.saveState(), "saved");
  EXPECT_EQ(mergeTimes(later, 1, 30), std::vector<int>{kOldEnough - kSaved});
}

}  // namespace
}  // namespace haptic_cloth::decision_times_test
