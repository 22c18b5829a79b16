/// Strips that are folded sharply in free space, at rest, without gravity, contact or pins.
/// Criteria: such a strip opens by itself until it is flat. Nothing outside works on it and the air takes
/// energy, so its total energy never rises. Rises in all are at most 0.001 of the energy at the start; where
/// a step is as long as it takes a single cell to open, at most 0.1, the limit of the torture suite
/// (docs/stability.md).
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <cstdio>
#include <string>

#include "support/layers.h"
#include "support/scenes.h"
#include "support/tolerance.h"

namespace haptic_cloth::sharp_fold_test {
namespace {

constexpr double kHalf = 0.03;      // length of an arm, about [m]
constexpr double kRigidity = 1e-5;  // [N·m]
constexpr double kDensity = 0.15;   // [kg/m²]
constexpr double kDuration = 0.8;   // [s]
constexpr double kFlat = 0.01;      // of the strip's length

struct Fold {
  double spacing, time_step, angle;  // [m], [s], [degrees]
  Integrator integrator;
  double most_risen = 1e-3;  // of the energy at the start
};

void PrintTo(const Fold& fold, std::ostream* out) {
  *out << fold.spacing << " m, " << fold.time_step << " s, " << fold.angle << " degrees";
}

struct Opened {
  double distance;  // between the ends, over the strip's length [-]
  double risen;     // sum of all rises of the energy over that at the start [-]
};

Opened open(const Fold& fold) {
  LinearFabric linear;
  linear.rigidity = kRigidity;
  linear.areal_density = kDensity;
  linear.compression = 0.1;
  const int arm = static_cast<int>(kHalf / fold.spacing), cells = 2 * arm;
  Scene scene = sheetScene(makeFabric(linear), cells + 1, 5, cells * fold.spacing, 4.0 * fold.spacing);
  scene.gravity.setZero();
  scene.air_damping = 10.0;
  scene.cloth.self_contact = false;
  scene.solver.time_step = fold.time_step;
  scene.solver.integrator = fold.integrator;
  Simulation simulation(scene);
  const double half = 0.5 * fold.angle * EIGEN_PI / 180.0;
  placeCloth(simulation, [&](int i, int j) {
    const double along = (i - arm) * fold.spacing;
    return Vec3(along * std::cos(half), (j - 2) * fold.spacing, -std::abs(along) * std::sin(half));
  });
  double start = 0.0, last = 0.0, risen = 0.0;
  while (simulation.time() < kDuration) {
    simulation.step();
    const double now = simulation.energy().total();
    if (start == 0.0) start = last = now;
    risen += std::max(0.0, now - last);
    last = now;
  }
  const double ends = (particle(simulation, cells, 2) - particle(simulation, 0, 2)).norm();
  return {ends / (cells * fold.spacing), risen / start};
}

class SharpFold : public testing::TestWithParam<Fold> {};

TEST_P(SharpFold, OpensByItself) {
  const Fold& fold = GetParam();
  const Opened opened = open(fold);
  std::printf("B h^2/(rho l^4) %.2f: distance of the ends %.3f lengths, energy rises by %.2g\n",
              kRigidity * std::pow(fold.time_step, 2) / (kDensity * std::pow(fold.spacing, 4)),
              opened.distance, opened.risen);
  EXPECT_NEAR(opened.distance, 1.0, tolerance(kFlat));
  EXPECT_LE(opened.risen, tolerance(fold.most_risen));
}

INSTANTIATE_TEST_SUITE_P(
    Folds, SharpFold,
    testing::Values(Fold{5e-3, 1e-3, 175.0, Integrator::Euler}, Fold{3.9e-3, 2e-3, 175.0, Integrator::Euler},
                    Fold{3e-3, 1e-3, 175.0, Integrator::Euler}, Fold{3e-3, 2e-3, 165.0, Integrator::Bdf2},
                    Fold{2.5e-3, 1e-3, 175.0, Integrator::Euler}, Fold{2.5e-3, 1e-3, 175.0, Integrator::Bdf2},
                    Fold{2.5e-3, 2e-3, 150.0, Integrator::Euler},
                    Fold{2e-3, 2e-3, 170.0, Integrator::Euler, 0.1},
                    Fold{2e-3, 2e-3, 178.0, Integrator::Euler, 0.1}));

}  // namespace
}  // namespace haptic_cloth::sharp_fold_test
