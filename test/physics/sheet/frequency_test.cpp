/// Small swings of strips that hang from their top.
/// Criteria: the frequency of a chain, ω √(L/g) = j₀ₙ/2 (Bernoulli; Lamb); that of a clamped strip
/// with bending stiffness, computed by shooting; a linear oscillation under backward Euler: the
/// pole z = 1/(1 - iωh), so a phase of atan(ωh) and an energy factor of 1/(1 + ω²h²) per step; and
/// under BDF2, see dynamic_solutions.h.
#include <gtest/gtest.h>

#include <cmath>
#include <vector>

#include "support/dynamic_solutions.h"
#include "support/oscillation.h"
#include "support/record.h"
#include "support/scenes.h"
#include "support/tolerance.h"

namespace haptic_cloth::frequency_test {
namespace {

constexpr double kLength = 0.2;  // free part [m]
constexpr double kGravity = 9.81;
constexpr double kWeight = 0.15 * kGravity;  // [N/m²]
constexpr int kCells = 40;                   // number of finest cells of the free part
constexpr double kTilt = 0.02;               // [rad]; makes the period longer by kTilt²/16 = 2.5e-5

/// Frequency of a mode [rad/s].
double angular(const HangingMode& mode) { return mode.frequency * std::sqrt(kGravity / kLength); }

/// Straight strip slightly off the vertical, pinned at its first `clamp` + 1 columns.
Scene tiltedStrip(double rigidity, int clamp, Strategy strategy, double time_step, Integrator integrator,
                  double tilt = kTilt) {
  LinearFabric linear;
  linear.rigidity = rigidity;
  linear.stiffness = 2000.0;  // stretches by w L / 2 E < 1e-4
  const double spacing = kLength / kCells;
  Scene scene =
      sheetScene(makeFabric(linear), kCells + clamp + 1, 5, (kCells + clamp) * spacing, 4 * spacing);
  // A clamp must point straight down, so gravity is tilted instead.
  hangDown(scene);
  scene.gravity = kGravity * Vec3(std::sin(tilt), 0.0, -std::cos(tilt));
  pin(scene, 0, clamp, 0, 4);
  setStrategy(scene, strategy, 2);
  scene.solver.time_step = time_step;
  scene.solver.integrator = integrator;
  scene.solver.minimizer.tolerance = 1e-6;
  scene.solver.minimizer.max_iterations = 5000;
  return scene;
}

/// Deflection of the strip from its rest position, weighted with the shape of a mode, step by step.
class Swing {
 public:
  Swing(const Scene& scene, int clamp, const std::vector<double>& shape) : simulation_(scene), clamp_(clamp) {
    for (int k = 0; k <= kCells; ++k)
      weights_.push_back((k == 0 || k == kCells ? 0.5 : 1.0) * shape[k] / kCells);
  }

  /// Continues the run. @return the deflections [m]
  std::vector<double> run(int steps) {
    std::vector<double> values;
    for (int n = 0; n < steps; ++n) {
      const StepReport report = simulation_.step();
      EXPECT_EQ(report.minimizer.why, Termination::Converged);
      values.push_back(deflection());
    }
    return values;
  }

 private:
  double deflection() {
    simulation_.positions(positions_);
    const int columns = simulation_.scene().cloth.particles[kWarp];
    double sum = 0.0;
    for (int k = 0; k <= kCells; ++k) {  // middle row, from the tip up
      sum += weights_[k] * positions_[2 * columns + columns - 1 - k].x();
    }
    return sum;
  }

  Simulation simulation_;
  int clamp_;
  std::vector<double> weights_;
  std::vector<Vec3> positions_;
};

/// Swings for some periods and analyses the time after the first two, when higher modes have
/// decayed.
Oscillation swing(const HangingMode& mode, double rigidity, int clamp, Strategy strategy, double omega_h,
                  Integrator integrator = Integrator::Euler) {
  const double period = 2.0 * EIGEN_PI / backwardEulerPhase(omega_h);
  Swing strip(tiltedStrip(rigidity, clamp, strategy, omega_h / angular(mode), integrator), clamp, mode.shape);
  const std::vector<double> x = strip.run(static_cast<int>(4.0 * period));
  return fitOscillation(x, static_cast<int>(2.0 * period), static_cast<int>(0.2 * period));
}

struct Case {
  std::string name;
  double gamma;      // 0: chain
  double tolerance;  // tolerance of the finest mesh [-]
};

class HangingStripSwings : public testing::TestWithParam<std::tuple<Case, Strategy>> {};

TEST_P(HangingStripSwings, AtItsFrequency) {
  const auto& [c, strategy] = GetParam();
  const bool bends = c.gamma > 0.0;
  const HangingMode mode = bends ? hangingStripMode(c.gamma, 1, kCells) : hangingChainMode(1, kCells);
  const double rigidity = bends ? kWeight * std::pow(kLength, 3) / c.gamma : 0.0;
  const double omega_h = 0.05;
  const Oscillation found = swing(mode, rigidity, bends ? 4 : 0, strategy, omega_h);
  const double frequency = mode.frequency * std::tan(found.phase) / omega_h;
  record({"swing of a hanging strip", "frequency ω√(L/g) [-]", name(strategy), c.gamma, frequency,
          mode.frequency, mode.frequency});
  const double allowed = strategy == Strategy::Finest ? c.tolerance : 8.0 * c.tolerance;
  EXPECT_NEAR(frequency, mode.frequency, tolerance(allowed * mode.frequency));
}

// Lumped masses and links are second order. The spacing is 1/40 of the length, or 1/10 on a mesh
// that merged. A strip turns over L/√Γ at its clamp: 1.3 cells of the finest mesh for Γ = 1000.
INSTANTIATE_TEST_SUITE_P(
    Strategies, HangingStripSwings,
    testing::Combine(testing::Values(Case{"chain", 0.0, 1e-3}, Case{"gamma100", 100.0, 1e-3},
                                     Case{"gamma1000", 1000.0, 2e-3}),
                     testing::Values(Strategy::Finest, Strategy::Amrc, Strategy::Coarsest)),
    [](const auto& info) { return std::get<0>(info.param).name + "_" + name(std::get<1>(info.param)); });

struct Method {
  std::string name;
  Integrator integrator;
  double (*energy)(double phase);  ///< kept in a period, by the phase of a step [rad]
};

class Damping : public testing::TestWithParam<std::tuple<Method, double, Strategy>> {};

TEST_P(Damping, IsWhatThePoleSays) {
  const auto& [method, omega_h, strategy] = GetParam();
  const HangingMode mode = hangingChainMode(1, kCells);
  const Oscillation found = swing(mode, 0.0, 0, strategy, omega_h, method.integrator);
  // A chain of n links swings with a frequency slightly off ω; its pole must be that of its own
  // frequency.
  const double exact = method.energy(found.phase);
  record({"swing of a hanging chain, " + method.name, "energy kept in a period [-]", name(strategy), omega_h,
          found.energy, exact, 1.0});
  EXPECT_NEAR(found.energy, exact, tolerance(2e-3));
}

class DampingAtTheDefaultTolerance : public Damping {};

TEST_P(DampingAtTheDefaultTolerance, IsNearlyWhatThePoleSays) {
  // Forces of 0.1 g may be left undone, as much as those that let it swing. What they lack in one step others
  // may do too much, so only their sum counts. It may not change the amplitude by more than 1 % per period.
  // Which forces are left undone is chance: single swings differ by up to 3 % in energy between instruction
  // sets. So the mean of five swings from angles that differ a little counts.
  const auto& [method, omega_h, strategy] = GetParam();
  const HangingMode mode = hangingChainMode(1, kCells);
  const double period = 2.0 * EIGEN_PI / backwardEulerPhase(omega_h);
  double kept = 0.0, exact = 0.0;
  const auto angles = {0.096, 0.098, 0.1, 0.102, 0.104};  // [rad]
  for (const double angle : angles) {
    Scene scene = tiltedStrip(0.0, 0, strategy, omega_h / angular(mode), method.integrator, angle);
    scene.solver.minimizer = MinimizerOptions();
    Swing strip(scene, 0, mode.shape);
    const std::vector<double> x = strip.run(static_cast<int>(6.0 * period));
    const Oscillation found =
        fitOscillation(x, static_cast<int>(2.0 * period), static_cast<int>(0.2 * period));
    kept += found.energy / angles.size();
    exact += method.energy(found.phase) / angles.size();
  }
  record({"swing of a hanging chain, default tolerance, " + method.name, "energy kept in a period [-]",
          name(strategy), omega_h, kept, exact, 1.0});
  EXPECT_NEAR(kept, exact, tolerance(0.02));
}

const Method kMethods[] = {
    {"backward Euler", Integrator::Euler, [](double phase) { return backwardEulerEnergy(std::tan(phase)); }},
    {"BDF2", Integrator::Bdf2, [](double phase) { return bdf2Energy(bdf2Frequency(phase)); }}};

const Strategy kMeshes[] = {Strategy::Finest, Strategy::Amrc, Strategy::Coarsest};

std::string nameOf(const testing::TestParamInfo<Damping::ParamType>& info) {
  const auto& [method, omega_h, strategy] = info.param;
  return std::string(method.integrator == Integrator::Bdf2 ? "bdf2" : "euler") + "_h" +
         std::to_string(static_cast<int>(100 * omega_h)) + "_" + name(strategy);
}

INSTANTIATE_TEST_SUITE_P(Steps, Damping,
                         testing::Combine(testing::ValuesIn(kMethods), testing::Values(0.01, 0.05, 0.1),
                                          testing::ValuesIn(kMeshes)),
                         nameOf);

// 0.01 is a step of about 1 ms, the default.
INSTANTIATE_TEST_SUITE_P(Steps, DampingAtTheDefaultTolerance,
                         testing::Combine(testing::ValuesIn(kMethods), testing::Values(0.01),
                                          testing::ValuesIn(kMeshes)),
                         nameOf);

TEST(HangingModes, MatchTable) {
  // Values computed by shooting at higher order; those of the chain are half the zeros of J₀.
  const double chain[] = {1.202413, 2.760039, 4.326864}, strip[] = {1.286874, 3.650917, 7.898033},
               limp[] = {1.223659, 2.918153, 5.081843};
  for (int k = 0; k < 3; ++k) {
    EXPECT_NEAR(hangingChainMode(k + 1, 10).frequency, chain[k], tolerance(6e-7));
    EXPECT_NEAR(hangingStripMode(100.0, k + 1, 10).frequency, strip[k], tolerance(6e-7));
    EXPECT_NEAR(hangingStripMode(1000.0, k + 1, 10).frequency, limp[k], tolerance(6e-7));
  }
  EXPECT_NEAR(backwardEulerEnergy(0.01), .939102, tolerance(6e-7));
  EXPECT_NEAR(backwardEulerEnergy(0.05), .730498, tolerance(6e-7));
  EXPECT_NEAR(backwardEulerEnergy(0.10), .534044, tolerance(6e-7));
  EXPECT_NEAR(bdf2Energy(0.01), .999997, tolerance(6e-7));
  EXPECT_NEAR(bdf2Energy(0.05), .999609, tolerance(6e-7));
  EXPECT_NEAR(bdf2Energy(0.10), .996930, tolerance(6e-7));
  EXPECT_NEAR(bdf2Energy(0.50), .771658, tolerance(6e-7));
}

}  // namespace
}  // namespace haptic_cloth::frequency_test
