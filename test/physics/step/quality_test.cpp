/// Steps of other lengths and lower quality under a hand.
/// Criteria: at rest a change of either changes the force by at most 2 % from one step to the next, and in
/// all by less than a hand can tell, 5 to 7 % (docs/model.md).
#include <gtest/gtest.h>

#include <algorithm>
#include <functional>

#include "haptics/quality_ladder.h"
#include "support/scenes.h"
#include "support/tolerance.h"

namespace haptic_cloth {
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

/// A probe presses 15 mm deep into a sheet that is held on all sides.
Scene pressedSheet(Integrator integrator) {
  Scene scene = touchedDrape(integrator);
  scene.obstacles.clear();
  scene.cloth.size = {0.2, 0.2};
  pinAllSides(scene);
  scene.air_damping = 5.0;
  scene.probes[0].path = {{0.0, Vec3(0.0, 0.0, 0.01)}, {0.3, Vec3(0.0, 0.0, -0.007)}};
  return scene;
}

void step(Simulation& simulation, int length) {
  followPaths(simulation, length);
  simulation.step(length);
}

/// Takes steps with each length, and compares the force with that before the last change.
void expectSameForce(Simulation& simulation, const std::vector<int>& lengths,
                     const std::function<void(std::size_t)>& change) {
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
    EXPECT_LE(most_at_once, tolerance(kAtOnce)) << "change " << k;
    EXPECT_LE(most, tolerance(kInAll)) << "change " << k;
  }
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

INSTANTIATE_TEST_SUITE_P(Scenes, QualityAtRest,
                         testing::Values(Case{"drape", touchedDrape(Integrator::Euler)},
                                         Case{"drape_bdf2", touchedDrape(Integrator::Bdf2)},
                                         Case{"sheet", pressedSheet(Integrator::Euler)},
                                         Case{"sheet_bdf2", pressedSheet(Integrator::Bdf2)}),
                         [](const auto& info) { return info.param.name; });

}  // namespace
}  // namespace haptic_cloth
