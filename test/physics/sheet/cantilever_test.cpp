/// Strip clamped at one end under its own weight.
/// Criterion: the heavy elastica (Bickley 1934), computed in test/support; the same case is the
/// first cloth benchmark of Romero et al. 2021 (ACM TOG 40(4)).
#include <gtest/gtest.h>

#include <cmath>

#include "support/record.h"
#include "support/reference_solutions.h"
#include "support/scenes.h"
#include "support/tolerance.h"

namespace haptic_cloth::cantilever_test {
namespace {

constexpr double kLength = 0.2;          // free part [m]
constexpr double kWeight = 0.15 * 9.81;  // [N/m²]

/// Strip of `cells` free finest cells after a clamp of `clamp` cells whose particles are all
/// pinned.
Scene clampedStrip(double lambda, int cells, int clamp, int levels) {
  LinearFabric linear;
  linear.rigidity = kWeight * std::pow(kLength / lambda, 3);
  linear.stiffness = 2000.0;  // stretches by w L / 2 E < 1e-4
  const double spacing = kLength / cells;
  const int weft = 1 << std::max(levels, 1);
  Scene scene =
      sheetScene(makeFabric(linear), cells + clamp + 1, weft + 1, (cells + clamp) * spacing, weft * spacing);
  pin(scene, 0, clamp, 0, weft);
  quasiStatic(scene, 15.0, 5e-3, 1e-5);
  setStrategy(scene, Strategy::Finest, levels);
  return scene;
}

struct Tip {
  double x, drop;  ///< over the free length [-]
};

Tip tipAtRest(const Scene& scene, int clamp) {
  Simulation simulation(scene);
  const Settled settled = settle(simulation, 2e-5, 4.0);
  EXPECT_TRUE(settled.at_rest);
  EXPECT_EQ(settled.failed_steps, 0);
  EXPECT_EQ(settled.unconverged, 0) << "of " << settled.steps;
  const Vec3 root = particle(simulation, clamp, 1);
  const Vec3 tip = particle(simulation, scene.cloth.particles[kWarp] - 1, 1);
  EXPECT_NEAR(tip.y(), root.y(), tolerance(1e-6)) << "the strip left its plane";
  return {(tip.x() - root.x()) / kLength, (root.z() - tip.z()) / kLength};
}

void recordTip(Strategy strategy, double lambda, const Tip& tip, const Cantilever& exact) {
  record({"heavy cantilever", "drop/L [-]", name(strategy), lambda, tip.drop, exact.drop, 1.0});
  record({"heavy cantilever", "x/L [-]", name(strategy), lambda, tip.x, exact.x, 1.0});
}

TEST(HeavyElasticaCurve, DroopsFartherTheLongerItIs) {
  Cantilever before{0.0, 1.0, 0.0, 0.0};
  for (int k = 1; k <= 20; ++k) {  // for the plot
    const double lambda = 0.2 * k;
    const Cantilever tip = heavyElastica(lambda);
    EXPECT_LT(tip.x, before.x);
    EXPECT_GT(tip.drop, before.drop);
    record({"heavy cantilever", "drop/L [-]", "reference", lambda, tip.drop, tip.drop, 1.0});
    record({"heavy cantilever", "x/L [-]", "reference", lambda, tip.x, tip.x, 1.0});
    before = tip;
  }
}

class HeavyStrip : public testing::TestWithParam<double> {};

TEST_P(HeavyStrip, FinestMatchesElastica) {
  const Cantilever exact = heavyElastica(GetParam());
  const Tip tip = tipAtRest(clampedStrip(GetParam(), 40, 1, 0), 1);
  recordTip(Strategy::Finest, GetParam(), tip, exact);
  EXPECT_NEAR(tip.drop, exact.drop, tolerance(0.02 * exact.drop));
  EXPECT_NEAR(tip.x, exact.x, tolerance(0.02 * exact.x));
}

INSTANTIATE_TEST_SUITE_P(Lambda, HeavyStrip, testing::Values(0.5, 1.0, 2.0, 3.0, 4.0));

/// Largest error of the tip's position over the length, for adaptive and coarse meshes.
class AdaptiveStrip : public testing::TestWithParam<std::tuple<Strategy, double>> {};

TEST_P(AdaptiveStrip, StaysNearElastica) {
  const auto [strategy, lambda] = GetParam();
  const Cantilever exact = heavyElastica(lambda);
  Scene scene = clampedStrip(lambda, 40, 4, 2);
  scene.adapt.strategy = strategy;
  const Tip tip = tipAtRest(scene, 4);
  const double error = std::hypot(tip.x - exact.x, tip.drop - exact.drop);
  recordTip(strategy, lambda, tip, exact);
  // A chain of 10 links, the coarsest mesh, has an error of 1.0 % of the drop at λ = 2 (ClampOrder
  // below), which is 0.6 L; as much may be missing from x. The mesh refines only where the turning angle
  // at a node is above refine_above.
  EXPECT_LE(error, tolerance(0.0085));
}

INSTANTIATE_TEST_SUITE_P(Strategies, AdaptiveStrip,
                         testing::Combine(testing::Values(Strategy::Coarsest, Strategy::Refine,
                                                          Strategy::Amrc),
                                          testing::Values(0.5, 1.0, 2.0, 3.0, 4.0)),
                         [](const auto& info) {
                           return name(std::get<0>(info.param)) + "_lambda" +
                                  std::to_string(static_cast<int>(10 * std::get<1>(info.param)));
                         });

TEST(ClampOrder, ErrorFallsWithSquareOfSpacing) {
  // A clamp that acts over half a cell is second order; over a full cell it is first order (ratio
  // 2, 10.9 % at N = 10). A chain of 10/20/40 links with κ = φ/h has drop errors of .756/.189/.047
  // % at λ = 2. Here κ = 2 sin(φ/2)/h, lower by φ²/24, adds a third, and the stretch wL/2E adds
  // 0.007 %.
  const double lambda = 2.0;
  const double exact = heavyElastica(lambda).drop;
  double errors[3];
  for (int k = 0; k < 3; ++k) {
    Scene scene = clampedStrip(lambda, 10 << k, 1, 0);
    scene.solver.minimizer.tolerance = 1e-6;
    const double drop = tipAtRest(scene, 1).drop;
    errors[k] = std::abs(drop / exact - 1.0);
    record({"heavy cantilever convergence", "drop/L [-]", "finest", 10.0 * (1 << k), drop, exact, exact});
  }
  EXPECT_LE(errors[0], tolerance(0.0125));
  EXPECT_GT(errors[0] / errors[1], 3.0);
  EXPECT_GT(errors[1] / errors[2], 3.0);
}

}  // namespace
}  // namespace haptic_cloth::cantilever_test
