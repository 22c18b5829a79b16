/// Sheets in pure tension.
/// Criteria: extension w L²/2E of a strip that hangs under its own weight (any text on strength of
/// materials); the same by quadrature for a nonlinear law; the elastic catenary (Irvine 1981).
#include <gtest/gtest.h>

#include <cmath>

#include "support/record.h"
#include "support/reference_solutions.h"
#include "support/scenes.h"
#include "support/tolerance.h"

namespace haptic_cloth::hanging_test {
namespace {

constexpr double kWeight = 0.15 * 9.81;  // [N/m²]

Scene hangingStrip(const Fabric& fabric, Strategy strategy) {
  Scene scene = sheetScene(fabric, 41, 5, 0.4, 0.04);
  hangDown(scene);
  pin(scene, 0, 0, 0, 4);
  setStrategy(scene, strategy, 2);
  quasiStatic(scene, 20.0, 5e-3, 1e-5);
  return scene;
}

double extension(const Simulation& simulation) {
  const double length = simulation.scene().cloth.size[kWarp];
  return (particle(simulation, 0, 2) - particle(simulation, 40, 2)).norm() - length;
}

class HangingStrip : public testing::TestWithParam<Strategy> {};

TEST_P(HangingStrip, ExtendsByHalfWeight) {
  LinearFabric linear;
  linear.stiffness = 50.0;  // soft: the extension, 2.4 mm, is far above the error of the solver
  Simulation simulation(hangingStrip(makeFabric(linear), GetParam()));
  const Settled settled = settle(simulation, 1e-5, 3.0);
  EXPECT_TRUE(settled.at_rest);
  EXPECT_EQ(settled.failed_steps, 0);
  // Half cells at both ends make the midpoint rule exact for a linear law on any mesh. Only the
  // residual and the last motion remain.
  const double exact = kWeight * 0.4 * 0.4 / (2.0 * linear.stiffness);
  record({"hanging strip, linear law", "extension [mm]", name(GetParam()), 0.0, 1e3 * extension(simulation),
          1e3 * exact, 1e3 * exact});
  EXPECT_NEAR(extension(simulation), exact, tolerance(1e-3 * exact));
  EXPECT_NEAR(simulation.supportForce().z(), simulation.mass() * 9.81, tolerance(1e-3 * kWeight * 0.016));
}

TEST_P(HangingStrip, FollowsNonlinearLaw) {
  // Stiffening law T(ε) = a ε + b ε²; ε(T) is its inverse.
  const double a = 20.0, b = 2000.0;
  std::vector<double> forces;
  const double step = 2e-4;
  for (int k = -1; k <= 1000; ++k)
    forces.push_back(k < 0 ? -a * step : a * k * step + b * k * k * step * step);
  Fabric fabric = makeFabric({});
  fabric.tensile = {Curve(-step, step, forces), Curve(-step, step, forces)};
  Simulation simulation(hangingStrip(fabric, GetParam()));
  const Settled settled = settle(simulation, 1e-5, 3.0);
  EXPECT_TRUE(settled.at_rest);
  const double exact = hangingExtension(
      kWeight, 0.4, [&](double t) { return (-a + std::sqrt(a * a + 4.0 * b * t)) / (2.0 * b); });
  // Midpoint rule over 40 edges, or over 10 on a coarse mesh: its error (1/24) h² [ε'(T)] w is
  // below 1e-3.
  record({"hanging strip, stiffening law", "extension [mm]", name(GetParam()), 0.0,
          1e3 * extension(simulation), 1e3 * exact, 1e3 * exact});
  EXPECT_NEAR(extension(simulation), exact, tolerance(2e-3 * exact));
}

INSTANTIATE_TEST_SUITE_P(Strategies, HangingStrip,
                         testing::Values(Strategy::Finest, Strategy::Coarsest, Strategy::Amrc),
                         [](const auto& info) { return name(info.param); });

class HeldAtBothEnds : public testing::TestWithParam<Strategy> {};

TEST_P(HeldAtBothEnds, SagsLikeElasticCatenary) {
  const double span = 0.4;
  LinearFabric linear;
  linear.stiffness = 100.0 * kWeight * span;  // EA / (w S0) = 100
  Scene scene = sheetScene(makeFabric(linear), 41, 5, span, 0.04);
  pin(scene, 0, 0, 0, 4);
  pin(scene, 40, 40, 0, 4);
  setStrategy(scene, GetParam(), 2);
  quasiStatic(scene, 20.0, 5e-3, 1e-5);
  Simulation simulation(scene);
  const Settled settled = settle(simulation, 1e-5, 3.0);
  EXPECT_TRUE(settled.at_rest);
  const Catenary exact = elasticCatenary(1.0, 100.0);
  const double sag = (particle(simulation, 0, 2) - particle(simulation, 20, 2)).z() / span;
  const double error = sag / exact.sag - 1.0;
  record({"elastic catenary", "sag over span [-]", name(GetParam()), 0.0, sag, exact.sag, exact.sag});
  // A chain of n links has the sag of the curve up to O(1/n²): n = 40, or 10 on the coarsest mesh.
  // The turning angle at a link, 0.03 rad on the coarsest mesh, never refines it.
  EXPECT_NEAR(error, 0.0, tolerance(0.005));
  // Tension of the outermost edge, half an edge from the end.
  const int edges = GetParam() == Strategy::Finest ? 40 : 10;
  const double vertical = 0.5 * (1.0 - 1.0 / edges);
  const double strain = std::hypot(exact.horizontal, vertical) / 100.0;
  record({"elastic catenary", "largest strain [-]", name(GetParam()), 0.0, simulation.maxStrain(), strain,
          strain});
  EXPECT_NEAR(simulation.maxStrain(), strain, tolerance(0.02 * strain));
}

INSTANTIATE_TEST_SUITE_P(Strategies, HeldAtBothEnds,
                         testing::Values(Strategy::Finest, Strategy::Coarsest, Strategy::Amrc),
                         [](const auto& info) { return name(info.param); });

}  // namespace
}  // namespace haptic_cloth::hanging_test
