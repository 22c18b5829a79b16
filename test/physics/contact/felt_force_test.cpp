/// Force vector on a probe under AMRC, compared with that of the finest mesh with the same options.
/// A probe presses and slides by 20 mm or more on sheets of 33 × 33 particles of winter suiting: on
/// loose sheets, where folds and waves affect it, beside an edge of a box and beside a fold.
/// Criterion: rms of the difference over rms of the force. It may be 5 %, below what a hand
/// distinguishes [Jones 1989; Pang, Tan & Durlach 1991], plus the change of the finest mesh's own
/// force with half the time step, below which the force is not known.
#include <gtest/gtest.h>

#include <cmath>
#include <string>
#include <vector>

#include "support/record.h"
#include "support/scenes.h"
#include "support/tolerance.h"

namespace haptic_cloth::felt_force_test {
namespace {

Fabric suiting() { return loadFabric(HAPTIC_CLOTH_SOURCE_DIR "/config/fabrics/winter_suiting.yaml"); }

Scene sheet(double size, double height) {
  Scene scene = sheetScene(suiting(), 33, 33, size, size);
  setStrategy(scene, Strategy::Amrc, 2);
  scene.cloth.pose.position.z() = height;
  scene.air_damping = 0.5;
  return scene;
}

/// Sheet with warp along x and weft upwards, held at its upper edge.
Scene hung(double size) {
  Scene scene = sheet(size, 0.2);
  scene.cloth.pose.orientation = Quat(Eigen::AngleAxisd(0.5 * EIGEN_PI, Vec3::UnitX()));
  pin(scene, 0, 32, 32, 32);
  return scene;
}

/// Sheet pushed by 30 mm; then the probe slides.
Scene pushed() {
  Scene scene = hung(0.2);
  scene.probes[0].path = {{0.0, Vec3(0, -0.02, 0.18)},
                          {0.2, Vec3(0, -0.01, 0.18)},
                          {0.4, Vec3(0, 0.02, 0.18)},
                          {0.6, Vec3(0.02, 0.02, 0.18)}};
  return scene;
}

/// Sheet with folds from the probe to the corners: bench/scenes/sheet_pushed.yaml.
Scene lifted() {
  Scene scene = hung(0.16);
  scene.probes[0].radius = 0.012;
  scene.probes[0].path = {{0.0, Vec3(0, -0.016, 0.16)},
                          {0.1, Vec3(0, -0.014, 0.16)},
                          {0.6, Vec3(0, 0.06, 0.2)},
                          {0.7, Vec3(0, 0.06, 0.2)}};
  return scene;
}

/// Sheet over a box that it overhangs on all sides; the probe comes once it hangs.
Scene draped(const Vec3& clear, const Vec3& pressed, const Vec3& slid) {
  Scene scene = sheet(0.3, 0.105);
  Obstacle box;
  box.shape = Shape::Box;
  box.size = Vec3(0.15, 0.15, 0.1);
  box.pose.position.z() = 0.05;
  box.friction = 0.3;
  scene.obstacles = {box};
  scene.probes[0].path = {{0.6, clear}, {0.8, pressed}, {1.0, slid}};
  return scene;
}

struct Case {
  std::string name;
  Scene scene;
};

std::vector<Case> cases() {
  return {{"hung, slid", pushed()},
          {"hung, lifted", lifted()},
          {"edge", draped(Vec3(0.1, 0, 0.13), Vec3(0.077, 0, 0.103), Vec3(0.077, 0.02, 0.103))},
          {"fold", draped(Vec3(0.14, 0.055, 0.05), Vec3(0.08, 0.055, 0.05), Vec3(0.08, 0.075, 0.05))}};
}

/// Forces at the end of each millisecond, from the second point of the path on.
std::vector<Vec3> felt(const Scene& scene) {
  const std::vector<PathPoint>& path = scene.probes[0].path;
  const double h = scene.solver.time_step, from = path[path.size() - 3].time, until = path.back().time;
  const int each = static_cast<int>(std::lround(1e-3 / h)), steps = static_cast<int>(std::lround(until / h));
  Simulation simulation(scene);
  std::vector<Vec3> forces;
  for (int step = 1; step <= steps; ++step) {
    const Vec3 start = pathPosition(path, (step - 1) * h), end = pathPosition(path, step * h);
    simulation.setDevice(end, (end - start) / h);
    simulation.step();
    if (step % each == 0 && step * h > from) forces.push_back(simulation.probe().force);
  }
  return forces;
}

/// Rms of the difference over rms of `b`.
double difference(const std::vector<Vec3>& a, const std::vector<Vec3>& b) {
  double apart = 0.0, size = 0.0;
  for (std::size_t k = 0; k < b.size(); ++k) {
    apart += (a[k] - b[k]).squaredNorm();
    size += b[k].squaredNorm();
  }
  return std::sqrt(apart / size);
}

class FeltForce : public testing::TestWithParam<int> {};

TEST_P(FeltForce, IsTheFinestMeshs) {
  const Case felt_case = cases()[GetParam()];
  Scene scene = felt_case.scene;
  const std::vector<Vec3> amrc = felt(scene);
  setStrategy(scene, Strategy::Finest, 2);
  const std::vector<Vec3> finest = felt(scene);
  scene.solver.time_step *= 0.5;
  const double known = difference(felt(scene), finest), error = difference(amrc, finest);
  record({"force on a probe, " + felt_case.name, "error of the vector [-]", "amrc", 0.0, error, 0.0, 1.0});
  record({"force on a probe, " + felt_case.name, "change with half the step [-]", "finest", 0.0, known, 0.0,
          1.0});
  EXPECT_LT(error, tolerance(0.05 + known)) << felt_case.name;
}

INSTANTIATE_TEST_SUITE_P(Scenes, FeltForce, testing::Range(0, 4));

}  // namespace
}  // namespace haptic_cloth::felt_force_test
