/// Steps of other lengths and lower quality under a hand.
/// Criterion: at rest a change of either changes the force by at most 2 %, below the 5 to 7 % that a hand
/// can tell (docs/model.md).
#include <gtest/gtest.h>

#include <algorithm>
#include <functional>

#include "haptics/quality_ladder.h"
#include "support/scenes.h"
#include "support/tolerance.h"

namespace haptic_cloth {
namespace {

constexpr double kNotFelt = 0.02;  // of the force

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

void step(Simulation& simulation, int length) {
  followPaths(simulation, length);
  simulation.step(length);
}

/// Takes steps with each length, and compares the force with that before.
void expectSameForce(Simulation& simulation, const std::vector<int>& lengths,
                     const std::function<void(std::size_t)>& change) {
  const Vec3 usual = simulation.probe().force;
  ASSERT_GT(usual.norm(), 0.1);
  for (std::size_t k = 0; k < lengths.size(); ++k) {
    change(k);
    double worst = 0.0;
    for (int n = 0; n < 30; ++n) {
      step(simulation, lengths[k]);
      worst = std::max(worst, (simulation.probe().force - usual).norm() / usual.norm());
    }
    EXPECT_LE(worst, tolerance(kNotFelt)) << "change " << k;
  }
}

class QualityAtRest : public testing::TestWithParam<Integrator> {
 protected:
  QualityAtRest() : simulation_(touchedDrape(GetParam())) {
    while (simulation_.time() < 1.5) step(simulation_, 1);
  }
  Simulation simulation_;
};

TEST_P(QualityAtRest, TheLengthOfAStepIsNotFelt) {
  expectSameForce(simulation_, {2, 4, 8, 4, 2, 1}, [](std::size_t) {});
}

TEST_P(QualityAtRest, ARungIsNotFelt) {
  const Scene scene = simulation_.scene();
  std::vector<Quality> rungs = qualityLadder(scene.solver, scene.adapt, 4);
  for (std::size_t k = rungs.size() - 1; k-- > 0;) rungs.push_back(rungs[k]);  // and back
  std::vector<int> lengths;
  for (const Quality& rung : rungs) lengths.push_back(rung.longest_step);
  expectSameForce(simulation_, lengths, [&](std::size_t k) {
    simulation_.setOptions(rungs[k].solver, rungs[k].adapt, scene.air_damping);
  });
}

INSTANTIATE_TEST_SUITE_P(Integrators, QualityAtRest, testing::Values(Integrator::Euler, Integrator::Bdf2));

}  // namespace
}  // namespace haptic_cloth
