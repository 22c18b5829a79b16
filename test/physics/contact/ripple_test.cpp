/// Force on the hand while the probe slides over the mesh.
/// Criterion: the force on a frictionless probe that slides at constant depth over a membrane
/// varies smoothly. The deviation from a polynomial of degree four in the position is ripple of the
/// mesh. It must be below 3 % of the mean, less than half of the 7 % by which a person
/// distinguishes two forces. Without friction, a flat support exerts no force along itself; what a probe
/// feels there along cloth that lies on it has the same limit.
#include "support/ripple.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <string>
#include <vector>

#include "support/record.h"
#include "support/scenes.h"
#include "support/tolerance.h"

namespace haptic_cloth::ripple_test {
namespace {

struct Slide {
  std::string label;
  Strategy strategy;
  int levels;
  double radius;     ///< [m]
  double depth;      ///< depth of the device below first touch [m]
  double direction;  ///< angle to warp [degrees]
  double limit;      ///< limit of the ripple [-]
};

class SlidingProbe : public testing::TestWithParam<Slide> {};

TEST_P(SlidingProbe, FeelsNoMesh) {
  const Slide& slide = GetParam();
  LinearFabric linear;
  linear.stiffness = 1000.0;
  linear.shear_modulus = 100.0;
  linear.rigidity = 1e-5;
  Scene scene = sheetScene(makeFabric(linear), 41, 41, 0.125, 0.125);
  setStrategy(scene, slide.strategy, slide.levels);
  pinAllSides(scene);
  ProbeOptions& probe = scene.probes[0];
  probe.radius = slide.radius;
  probe.friction = 0.0;
  probe.coupling_stiffness = 1000.0;
  quasiStatic(scene, 30.0, 2e-3, 1e-3);
  Simulation simulation(scene);
  const double angle = slide.direction * 3.14159265358979323846 / 180.0;
  const Vec3 along(std::cos(angle), std::sin(angle), 0.0), start = -0.015 * along + Vec3(0.0, 7e-4, 0.0);
  const double h = scene.solver.time_step, down = 0.1, slow = 0.04;
  const double height = slide.radius + 0.001;
  const auto go = [&](const Vec3& from, const Vec3& to, double time, const auto& look) {
    const int steps = static_cast<int>(std::lround(time / h));
    for (int k = 1; k <= steps; ++k) {
      simulation.setDevice(from + (k * 1.0 / steps) * (to - from), (to - from) / time);
      simulation.step();
      look(k * 0.03 / steps);
    }
  };
  const Vec3 above = start + height * Vec3::UnitZ(),
             below = start + (slide.radius - slide.depth) * Vec3::UnitZ();
  go(above, below, (height - slide.radius + slide.depth) / down, [](double) {});
  go(below, below, 0.2, [](double) {});
  std::vector<double> way, force;
  go(below, below + 0.03 * along, 0.03 / slow, [&](double x) {
    way.push_back((x - 0.015) / 0.015);
    force.push_back(simulation.probe().force.z());
  });
  const double value = ripple(way, force, 4);
  record({"probe sliding over a membrane", "ripple of the force / mean, %", slide.label, slide.direction,
          100.0 * value, 0.0, 3.0});
  EXPECT_LT(value, tolerance(slide.limit));
}

INSTANTIATE_TEST_SUITE_P(Slides, SlidingProbe,
                         testing::Values(Slide{"finest", Strategy::Finest, 0, 0.008, 0.010, 0.0, 0.03},
                                         Slide{"finest_shallow", Strategy::Finest, 0, 0.008, 0.004, 0.0,
                                               0.03},
                                         Slide{"finest_askew", Strategy::Finest, 0, 0.008, 0.010, 20.0, 0.03},
                                         Slide{"amrc", Strategy::Amrc, 2, 0.008, 0.010, 0.0, 0.03},
                                         Slide{"amrc_askew", Strategy::Amrc, 2, 0.008, 0.010, 20.0, 0.03},
                                         Slide{"coarsest", Strategy::Coarsest, 2, 0.008, 0.010, 0.0, 0.17},
                                         Slide{"thin_probe", Strategy::Finest, 0, 0.002, 0.004, 0.0, 0.05}),
                         [](const auto& info) { return info.param.label; });

struct Stroke {
  std::string label;
  double thickness;  ///< of the cloth [m]
  double radius;     ///< [m]
  double push;       ///< depth of the device below the support, about push/400 N [m]
};

class StrokingProbe : public testing::TestWithParam<Stroke> {};

TEST_P(StrokingProbe, FeelsNoMesh) {
  const Stroke& stroke = GetParam();
  constexpr double kSpacing = 4e-3, kWay = 3.3 * kSpacing, kSpeed = 0.04;
  LinearFabric linear;
  linear.rigidity = 1e-5;
  linear.thickness = stroke.thickness;
  Scene scene = sheetScene(makeFabric(linear), 17, 17, 16 * kSpacing, 16 * kSpacing);
  Obstacle plane;
  plane.shape = Shape::Plane;
  plane.friction = 1.0;
  scene.obstacles.push_back(plane);
  scene.cloth.pose.position.z() = stroke.thickness;
  scene.air_damping = 30.0;
  scene.solver.minimizer.tolerance = 1e-2;
  ProbeOptions& probe = scene.probes[0];
  probe.radius = stroke.radius;
  probe.friction = 0.0;
  Simulation simulation(scene);
  const double h = scene.solver.time_step, out = stroke.radius + 3.0 * stroke.thickness,
               in = stroke.radius - stroke.push;
  const Vec3 along(std::cos(0.3), std::sin(0.3), 0.0), start = -0.5 * kWay * along;
  constexpr int kPress = 300;
  for (int k = 1; k <= kPress; ++k) {
    const double z = out + std::min(1.0, k / 200.0) * (in - out);
    simulation.setDevice(start + Vec3(0.0, 0.0, z), Vec3::Zero());
    simulation.step();
  }
  const int steps = static_cast<int>(kWay / (kSpeed * h));
  double most = 0.0, mean = 0.0;
  for (int k = 1; k <= steps; ++k) {
    simulation.setDevice(start + k * h * kSpeed * along + Vec3(0.0, 0.0, in), kSpeed * along);
    simulation.step();
    const Vec3 force = simulation.probe().force;
    most = std::max(most, force.head<2>().norm());
    mean += force.z() / steps;
  }
  record({"probe stroking cloth on a table", "largest force along it / mean force, %", stroke.label, mean,
          100.0 * most / mean, 0.0, 3.0});
  EXPECT_GT(mean, 0.0);
  EXPECT_LT(most, tolerance(0.03) * mean);
}

INSTANTIATE_TEST_SUITE_P(Strokes, StrokingProbe,
                         testing::Values(Stroke{"thin_light", 2e-4, 0.008, 5e-4},
                                         Stroke{"thin_firm", 2e-4, 0.008, 3e-3},
                                         Stroke{"thick", 8e-4, 0.008, 2e-3},
                                         Stroke{"thin_probe", 2e-4, 0.003, 2e-3}),
                         [](const auto& info) { return info.param.label; });

}  // namespace
}  // namespace haptic_cloth::ripple_test
