/// Layers of one cloth on each other.
/// Criteria: Coulomb's law; the laws of compression and contact, alone and in series; conservation of
/// momentum.
#include "support/layers.h"

#include <gtest/gtest.h>

#include <cmath>
#include <limits>

#include "contact/compression_law.h"
#include "support/record.h"
#include "support/reference_solutions.h"
#include "support/scenes.h"
#include "support/tolerance.h"

namespace haptic_cloth::layers_test {
namespace {

constexpr double kGravity = 9.81, kDensity = 0.15;  // [m/s²], [kg/m²]

/// A layer of 9 x 9 particles on a pinned layer. Gravity is tilted along weft, so the layer slides along
/// the fold. The row of cells that joins both has slack for 3 mm, and the pinned layer reaches 4 mm
/// farther on both sides.
class Slope {
 public:
  /// @param tilt [rad]
  Slope(double tilt, double friction, Strategy strategy) : simulation_(scene(tilt, friction, strategy)) {
    const double height =
        layerDistance(simulation_.scene().cloth.fabric, kDensity * kGravity * std::cos(tilt));
    placeCloth(simulation_, [&](int i, int j) {
      const double y = (j - 4) * kSpacing;
      if (i <= kPinned) return Vec3(i * kSpacing, 1.25 * y, 0.0);
      if (i == kPinned + 1)
        return Vec3(kPinned * kSpacing, y, 3.0 * simulation_.scene().cloth.fabric.thickness);
      return Vec3((kPinned - 0.5 - (i - kPinned - 2)) * kSpacing, y, height);
    });
  }

  Simulation& operator*() { return simulation_; }
  Simulation* operator->() { return &simulation_; }

  /// Mean position of the sliding layer along the slope [m].
  double slid() const {
    std::vector<Vec3> x;
    simulation_.positions(x);
    double sum = 0.0;
    for (int j = 0; j < 9; ++j) {
      for (int i = kPinned + 2; i < kColumns; ++i) sum += x[j * kColumns + i].y();
    }
    return sum / (9 * 9);
  }

 private:
  static constexpr int kPinned = 10, kColumns = 21;
  static constexpr double kSpacing = 4e-3;

  static Scene scene(double tilt, double friction, Strategy strategy) {
    Scene scene = layersScene({{kColumns}, 9, kSpacing}, slackFabric(kDensity, false));
    setStrategy(scene, strategy, 2);
    scene.adapt.start = StartMesh::Finest;
    pin(scene, 0, kPinned + 1, 0, 8);
    scene.cloth.self_friction = friction;
    scene.gravity = kGravity * Vec3(0.0, std::sin(tilt), -std::cos(tilt));
    scene.solver.time_step = 2e-3;
    scene.solver.minimizer.tolerance = 1e-3;
    scene.solver.minimizer.max_iterations = 1000;
    scene.solver.sleep_speed = 0.0;  // sleep would hold it, too
    return scene;
  }

  Simulation simulation_;
};

constexpr double kTilt = 20.0 * EIGEN_PI / 180.0;

class LayerOnLayer : public testing::TestWithParam<Strategy> {};

/// 5 % below the angle of friction. Held cloth must not creep: over a minute less than 1 µm. Nothing
/// sleeps, which would hold it, too. With amrc the mesh coarsens under the friction that it remembers.
TEST_P(LayerOnLayer, StaysForAMinute) {
  Slope slope(kTilt, std::tan(kTilt) / 0.95, GetParam());
  int coarsened = 0;
  while (slope->time() < 0.5) {
    const StepReport report = slope->step();
    ASSERT_FALSE(report.failed);
    coarsened += report.coarsened;
  }
  EXPECT_EQ(coarsened > 0, GetParam() == Strategy::Amrc);
  std::vector<Vec3> before, after;
  slope->positions(before);
  while (slope->time() < 60.5) slope->step();
  slope->positions(after);
  double moved = 0.0;
  for (std::size_t n = 0; n < before.size(); ++n) moved = std::max(moved, (after[n] - before[n]).norm());
  record({"layer on a layer tilted by 20°", "crept in a minute [µm]", name(GetParam()), 0.95, 1e6 * moved,
          0.0, 1.0});
  EXPECT_LT(moved, tolerance(1e-6));
}

/// The acceleration is measured once the layer has settled on the other. The residual, 1e-3 g rms,
/// bounds its error.
TEST_P(LayerOnLayer, SlidesAsCoulombSays) {
  for (const double friction : {0.1, 0.2, std::tan(kTilt) / 1.05}) {
    Slope slope(kTilt, friction, GetParam());
    const double h = slope->scene().solver.time_step;
    const auto speedAt = [&](double time) {
      double last = 0.0;
      while (slope->time() < time - 0.5 * h) {
        last = slope.slid();
        EXPECT_FALSE(slope->step().failed);
      }
      return (slope.slid() - last) / h;
    };
    const double start = speedAt(0.02), acceleration = (speedAt(0.05) - start) / 0.03;
    const double exact = kGravity * (std::sin(kTilt) - friction * std::cos(kTilt));
    record({"layer on a layer tilted by 20°", "acceleration [m/s²]", name(GetParam()), friction, acceleration,
            exact, exact});
    EXPECT_NEAR(acceleration, exact, tolerance(1e-3 * kGravity));
  }
}

INSTANTIATE_TEST_SUITE_P(Strategies, LayerOnLayer, testing::Values(Strategy::Finest, Strategy::Amrc),
                         [](const auto& info) { return name(info.param); });

/// Five layers lie on a floor, so each distance is the law's under the weight of the layers above. Where
/// nodes lie above nodes, the criterion is the residual: 1e-3 of the weight. Where layers are shifted, it is
/// the 7 % by which a person distinguishes two forces: neighbours carry unequal shares, as a node presses
/// on the corners of one triangle and the fabric does not resist bending.
class Pile : public testing::TestWithParam<std::tuple<bool, bool>> {};

TEST_P(Pile, IsAsThickAsItsLayersUnderTheirWeight) {
  constexpr int kLayers = 5, kSide = 13, kMargin = 3;
  const auto [measured, aligned] = GetParam();
  Layers layers{std::vector<int>(kLayers, kSide), kSide, 4e-3};
  if (aligned) layers.aside = Vec3::Zero();
  Scene scene = layersScene(layers, slackFabric(1.0, measured));
  scene.obstacles = {Obstacle()};
  quasiStatic(scene, 30.0, 1e-3, 1e-3);
  const Fabric& fabric = scene.cloth.fabric;
  Simulation simulation(scene);
  std::vector<double> heights;
  for (int k = 0; k < kLayers; ++k) heights.push_back((k + 1) * fabric.thickness);
  placeCloth(simulation, [&](int i, int j) { return placeInLayers(layers, heights, i, j); });
  const Settled settled = settle(simulation, 1e-5, 2.0);
  EXPECT_TRUE(settled.at_rest);
  EXPECT_EQ(settled.failed_steps, 0);
  std::vector<Vec3> x;
  simulation.positions(x);
  const auto height = [&](int layer) {  // mean away from the folds
    double sum = 0.0;
    for (int j = kMargin; j < kSide - kMargin; ++j) {
      for (int i = kMargin; i < kSide - kMargin; ++i) sum += x[(j * kLayers + layer) * kSide + i].z();
    }
    return sum / std::pow(kSide - 2 * kMargin, 2);
  };
  const double weight = kGravity * fabric.areal_density;
  const CompressionLaw between(fabric);
  const ContactLaw onFloor(fabric.thickness);
  double below = 0.0;
  for (int k = 0; k < kLayers; ++k) {
    const double apart = height(k) - below, exact = (kLayers - k) * weight;
    const double pressure = k == 0 ? onFloor(apart).pressure : between(apart).pressure;
    below = height(k);
    record({std::string("pile of five layers") + (aligned ? ", node above node" : ""),
            "pressure of the law at their distance [Pa]", measured ? "measured" : "not measured",
            double(kLayers - k), pressure, exact, exact});
    EXPECT_NEAR(pressure, exact, tolerance((aligned ? 1e-3 : 0.07) * exact)) << "layer " << k;
  }
}

std::string nameOfPile(const testing::TestParamInfo<std::tuple<bool, bool>>& info) {
  const auto [measured, aligned] = info.param;
  return std::string(measured ? "measured" : "not_measured") + (aligned ? "_node_above_node" : "");
}

INSTANTIATE_TEST_SUITE_P(Compression, Pile, testing::Combine(testing::Bool(), testing::Bool()), nameOfPile);

struct Press {
  int layers;
  bool measured;  ///< with data of KES-FB3
};

/// The probe feels two layers as twice as thick, and as two springs. The criterion is the 7 % by which a
/// person distinguishes two forces.
class PressedLayers : public testing::TestWithParam<Press> {};

TEST_P(PressedLayers, PressAsTheirLawsInSeries) {
  const auto [count, measured] = GetParam();
  constexpr int kSide = 17;
  const Layers layers{std::vector<int>(count, kSide), kSide, 2e-3};
  Scene scene = layersUnderSphere(layers, measured);
  ProbeOptions& probe = scene.probes[0];
  probe.coupling_stiffness = 5000.0;
  scene.gravity.setZero();
  const Fabric& fabric = scene.cloth.fabric;
  Simulation simulation(scene);
  std::vector<double> heights;
  for (int k = 0; k < count; ++k) heights.push_back((k + 1) * fabric.thickness);
  placeCloth(simulation, [&](int i, int j) { return placeInLayers(layers, heights, i, j); });
  const Vec3 middle = placeInLayers(layers, heights, kSide / 2, kSide / 2);
  const auto hold = [&](double height, double time) {
    const Vec3 device(middle.x(), middle.y(), probe.radius + height);
    for (const double end = simulation.time() + time; simulation.time() < end - 1e-9;) {
      simulation.setDevice(device, Vec3::Zero());
      const StepReport report = simulation.step();
      EXPECT_FALSE(report.failed);
    }
  };
  const double thickness = (count + 1) * fabric.thickness;
  hold(thickness + 1e-3, 0.01);
  for (const double depth : {0.4, 0.7}) {  // of the thickness
    hold(thickness * (1.0 - depth), 0.02);
    const ProbeReport report = simulation.probe();
    const double lowest = report.proxy.z() - probe.radius;
    const double exact = pressedLayers(fabric, count, probe.radius, lowest);
    record({"sphere on " + std::to_string(count) + " layers on a floor", "force [N]",
            measured ? "measured" : "not measured", lowest / thickness, report.force.z(), exact, exact});
    EXPECT_NEAR(report.force.z(), exact, tolerance(0.07 * exact));
  }
}

INSTANTIATE_TEST_SUITE_P(Layers, PressedLayers, testing::Values(Press{1, false}, Press{2, true}),
                         [](const auto& info) {
                           return std::to_string(info.param.layers) +
                                  (info.param.measured ? "_measured" : "_not_measured");
                         });

/// Masses of the particles of a sheet on its finest mesh [kg].
double massOf(const Scene& scene, int i, int j) {
  const auto& [columns, rows] = scene.cloth.particles;
  const double cell = scene.cloth.fabric.areal_density * scene.cloth.size[kWarp] / (columns - 1) *
                      scene.cloth.size[kWeft] / (rows - 1);
  return cell * (i % (columns - 1) == 0 ? 0.5 : 1.0) * (j % (rows - 1) == 0 ? 0.5 : 1.0);
}

/// Two layers without friction hit each other askew in free flight.
TEST(LayersInFlight, KeepMomentumWhenTheyHitEachOther) {
  constexpr int kSide = 9;
  constexpr double kTime = 0.03, kSpeed = 0.2;  // [s], [m/s]
  const Vec3 aside(0.02, 0.01, 0.0);            // [m/s]
  const Layers layers{{kSide, kSide}, kSide, 4e-3};
  Scene scene = layersScene(layers, slackFabric(kDensity, false));
  scene.gravity.setZero();
  scene.cloth.self_friction = 0.0;
  scene.solver.minimizer.tolerance = 1e-6;
  scene.solver.sleep_speed = 0.0;
  scene.solver.minimizer.max_iterations = 5000;
  Simulation simulation(scene);
  const double thickness = scene.cloth.fabric.thickness;
  placeCloth(
      simulation,
      [&](int i, int j) {
        return placeInLayers(layers, {0.0, 1.5 * thickness}, i, j);
      },
      [&](int i, int) { return Vec3(i / kSide * (aside - kSpeed * Vec3::UnitZ())); });
  std::vector<Vec3> before, after;
  simulation.positions(before);
  Vec3 first = Vec3::Zero(), momentum = first, spin_first = first, spin = first;
  for (int p = 0; p < 2 * kSide * kSide; ++p) {
    const int i = p % (2 * kSide);
    const Vec3 m = massOf(scene, i, p / (2 * kSide)) * (i / kSide) * (aside - kSpeed * Vec3::UnitZ());
    first += m;
    spin_first += before[p].cross(m);
  }
  const double h = scene.solver.time_step;
  int touching = 0;
  double energy = std::numeric_limits<double>::infinity(), unbalanced = 0.0;  // [J], [N·s]
  for (int step = 0; simulation.time() < kTime; ++step) {
    const StepReport report = simulation.step();
    ASSERT_FALSE(report.failed);
    touching = std::max(touching, report.self_contacts);
    simulation.positions(after);
    momentum = spin = Vec3::Zero();
    for (std::size_t n = 0; n < after.size(); ++n) {
      const Vec3 moved = massOf(scene, n % (2 * kSide), n / (2 * kSide)) / h * (after[n] - before[n]);
      momentum += moved;
      spin += after[n].cross(moved);
    }
    const double now = simulation.energy().total();
    const double left = report.minimizer.residual * kGravity * simulation.mass() * h;
    EXPECT_LE(now, energy + left * kSpeed) << "step " << step;  // and the work of the force that is left
    energy = now;
    unbalanced += left;
    before = after;
  }
  EXPECT_GT(touching, 50);
  record({"two layers that collide", "change of momentum / momentum [-]", "finest", 0.0,
          (momentum - first).norm() / first.norm(), 0.0, 1.0});
  record({"two layers that collide", "change of spin / spin [-]", "finest", 0.0,
          (spin - spin_first).norm() / spin_first.norm(), 0.0, 1.0});
  // Bound: what the residuals of all steps add up to. Backward Euler also changes the
  // spin, by h times motion across the force times the impulse.
  EXPECT_LT((momentum - first).norm(), tolerance(unbalanced));
  EXPECT_LT((spin - spin_first).norm(),
            tolerance(unbalanced * scene.cloth.size[kWarp] + h * aside.norm() * first.norm()));
}

}  // namespace
}  // namespace haptic_cloth::layers_test
