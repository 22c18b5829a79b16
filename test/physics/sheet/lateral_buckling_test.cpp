/// Lateral buckling: a strip held by one end with its wide side upright bends and twists out of its
/// plane if its own weight is too large.
///
/// Criterion: q L³ / √(EI·GJ) = 12.853763 (Prandtl 1899; a cloth benchmark in Romero et al. 2021,
/// ACM TOG 40(4)), and below it the twist under a small part of gravity to the side, a power series
/// in test/support.
///
/// EI and GJ of a strip of width b with w(x, y) = W(x) + y θ(x): its curvatures are κ_xx = W'' + y
/// θ'', κ_yy = 0, κ_xy = θ'. The energies per length are ∫ ½ B κ_xx² dy = ½ B b W''² + ½ (B b³/12)
/// θ''² and ∫ ½ 2 B_t κ_xy² dy = ½ (2 B_t b) θ'². So EI = B b and GJ = 2 B_t b; for an isotropic
/// plate, with B_t = (1 - ν) B, the latter is Saint-Venant's G t³ b / 3. Triples do not resist a
/// pure twist.
///
/// The formula neglects θ'' at the clamp. With its stiffness B b³/12, θ' starts from zero and
/// reaches its course within ℓ = b √(B/(24 B_t)). The strip acts as one shorter by ℓ = 0.007 L, so
/// Γ in the formula becomes Γ (1 - ℓ/L)³. Cells longer than ℓ resolve a part of this, cells of the
/// size of ℓ all of it.
///
/// Bending in the plane, EI_z = E b³/8 with two cells across, adds a factor 1/√((1 - EI/EI_z)(1 -
/// GJ/EI_z)) (Michell 1899), 0.4 %.
#include <gtest/gtest.h>

#include <array>
#include <cmath>
#include <iostream>

#include "support/buckling_solutions.h"
#include "support/record.h"
#include "support/scenes.h"
#include "support/tolerance.h"

namespace haptic_cloth::lateral_buckling_test {
namespace {

constexpr double kLength = 0.4;          // free part [m]
constexpr double kWidth = 0.02;          // [m]
constexpr double kWeight = 0.15 * 9.81;  // [N/m²]
constexpr double kTwistRatio = 2.0;      // B_t / B [-]

int levelsOf(Strategy strategy) { return strategy == Strategy::Finest ? 0 : 2; }
int clampOf(Strategy strategy) { return 1 << levelsOf(strategy); }

/// Strip along x, wide side along y, gravity along -y except for a small tilt [rad] to -z.
/// @param gamma q L³ / √(EI·GJ) = w L³ / √(2 B B_t)
Scene blade(double gamma, double tilt, int cells, Strategy strategy) {
  LinearFabric linear;
  linear.rigidity = kWeight * std::pow(kLength, 3) / (gamma * std::sqrt(2.0 * kTwistRatio));
  linear.stiffness = 5e4;
  linear.shear_modulus = 1e4;
  Fabric fabric = makeFabric(linear);
  fabric.twist_rigidity = kTwistRatio * linear.rigidity;
  const int clamp = clampOf(strategy), weft = std::max(2, clamp);
  Scene scene = sheetScene(fabric, cells + clamp + 1, weft + 1, (cells + clamp) * kLength / cells, kWidth);
  scene.gravity = 9.81 * Vec3(0.0, -std::cos(tilt), -std::sin(tilt));
  pin(scene, 0, clamp, 0, weft);
  quasiStatic(scene, 5.0, 0.01, 1e-5);
  setStrategy(scene, strategy, levelsOf(strategy));
  scene.adapt.minimum_age = 5;
  return scene;
}

/// Twist of the tip [rad], positive towards the flat side down.
double twist(const Simulation& simulation) {
  const std::array<int, 2> count = simulation.scene().cloth.particles;
  const Vec3 side =
      particle(simulation, count[kWarp] - 1, count[kWeft] - 1) - particle(simulation, count[kWarp] - 1, 0);
  return -std::atan2(side.z(), side.y());
}

double twistAtRest(const Scene& scene) {
  Simulation simulation(scene);
  const Settled settled = settle(simulation, 2e-6, 20.0);
  EXPECT_TRUE(settled.at_rest);
  EXPECT_EQ(settled.failed_steps, 0);
  EXPECT_EQ(settled.unconverged, 0) << "of " << settled.steps;
  return twist(simulation);
}

constexpr double kTilt = 1e-3;

/// Γ of an equivalent strip without stiffness against θ''.
double asWithoutWarping(double gamma) {
  return gamma * std::pow(1.0 - kWidth * std::sqrt(1.0 / (24.0 * kTwistRatio)) / kLength, 3);
}

/// Measured value of lateralStiffness(): tilt over (tilt + twist).
double measuredStiffness(double gamma, int cells, Strategy strategy) {
  return kTilt / (kTilt + twistAtRest(blade(gamma, kTilt, cells, strategy)));
}

/// Γ at which the stiffness vanishes, by the parabola Γ²(stiffness) through three loads.
template <class Stiffness>
double critical(Stiffness stiffness) {
  const std::array<double, 3> gamma{9.0, 11.0, 12.0};
  std::array<double, 3> s;
  for (int k = 0; k < 3; ++k) s[k] = stiffness(gamma[k]);
  double squared = 0.0;
  for (int k = 0; k < 3; ++k) {
    double factor = gamma[k] * gamma[k];
    for (int m = 0; m < 3; ++m) factor *= m == k ? 1.0 : s[m] / (s[m] - s[k]);
    squared += factor;
  }
  return std::sqrt(squared);
}

TEST(LateralSolution, MatchesTheLiterature) {
  EXPECT_NEAR(criticalLateral(), 12.853763, tolerance(6e-7));
  EXPECT_DOUBLE_EQ(lateralStiffness(0.0), 1.0);
  EXPECT_NEAR(critical(lateralStiffness), criticalLateral(), tolerance(2e-3 * criticalLateral()));
}

/// Expects a value between those without and with warping at the clamp, with `slack` on both sides.
void expectBetween(double value, double without, double with, double slack) {
  EXPECT_NEAR(value, 0.5 * (without + with), tolerance(0.5 * std::abs(with - without) + slack));
}

class Blade : public testing::TestWithParam<Strategy> {
 protected:
  int cells() const { return GetParam() == Strategy::Finest ? 20 : 40; }
};

TEST_P(Blade, LosesItsStiffnessAtTheCriticalLoad) {
  const auto stiffness = [&](double gamma) {
    const double value = measuredStiffness(gamma, cells(), GetParam()), exact = lateralStiffness(gamma);
    record({"lateral buckling", "tilt / (tilt + tip twist)", name(GetParam()), gamma, value, exact, 1.0});
    expectBetween(value, exact, lateralStiffness(asWithoutWarping(gamma)), 2e-3);
    return value;
  };
  stiffness(6.0);
  const double value = critical(stiffness), exact = critical(lateralStiffness);
  record({"lateral buckling", "critical q L^3 / sqrt(EI GJ)", name(GetParam()), 0.0, value, exact, exact});
  expectBetween(value, exact, exact * exact / asWithoutWarping(exact), 5e-3 * exact);
}

TEST_P(Blade, StaysUprightBelowAndTurnsOverAbove) {
  const double below = twistAtRest(blade(0.9 * criticalLateral(), kTilt, cells(), GetParam()));
  EXPECT_LT(std::abs(below), tolerance(0.01));
  EXPECT_GT(below, tolerance(0.0));
  // Buckled: a hundred tilts. The branch leaves the upright one slowly, 0.24 rad at 1.1 times the
  // load.
  Simulation simulation(blade(1.1 * criticalLateral(), kTilt, cells(), GetParam()));
  while (simulation.time() < 20.0 && twist(simulation) < 0.1) simulation.step();
  std::cout << "  tip twist " << name(GetParam()) << ": " << below << " below, " << twist(simulation)
            << " above at " << simulation.time() << " s\n";
  EXPECT_GE(twist(simulation), 0.1) << "still upright";
}

TEST_P(Blade, WithoutTwistTermNothingHoldsIt) {
  // At 8 % of the critical load the strip with its twist term turns by 1 % of the tilt.
  const double load = 1.0;
  Scene scene = blade(load, kTilt, cells(), GetParam());
  const double held = twistAtRest(scene);
  scene.cloth.fabric.twist_rigidity = 0.0;
  Simulation loose(scene);
  while (loose.time() < 5.0 && twist(loose) < 0.5) EXPECT_FALSE(loose.step().failed);
  record({"lateral buckling, twist term", "tip twist [rad]", name(GetParam()), load, held,
          kTilt * (1.0 / lateralStiffness(load) - 1.0), kTilt});
  EXPECT_NEAR(held, kTilt * (1.0 / lateralStiffness(load) - 1.0), tolerance(2e-3 * kTilt));
  EXPECT_GE(twist(loose), 0.5);
}

TEST(BladeOfShortCells, SeesTheClampHoldTheTwist) {
  // Cells are 5 mm long and ℓ is 2.9 mm.
  const double gamma = 9.0, exact = lateralStiffness(asWithoutWarping(gamma));
  const double value = measuredStiffness(gamma, 80, Strategy::Finest);
  record({"lateral buckling, short cells", "tilt / (tilt + tip twist)", "finest", gamma, value, exact, 1.0});
  EXPECT_NEAR(value, exact, tolerance(3e-3));
}

INSTANTIATE_TEST_SUITE_P(Strategies, Blade,
                         testing::Values(Strategy::Finest, Strategy::Amrc, Strategy::Coarsest),
                         [](const auto& info) { return name(info.param); });

}  // namespace
}  // namespace haptic_cloth::lateral_buckling_test
