/// Force and torque of the tick for poses that the solver has not seen, compared with the solver's own
/// at these poses. The hand moves at 0.2 m/s; snapshots reach the tick every 1, 5, 10 or 20 ms.
/// Criteria, relative to the running mean of the force's norm over 0.1 s: rms error at most 5 %; a
/// step of the force at a new snapshot below 7 %, the smallest change of a force that a hand
/// perceives [Jones 1989; Pang, Tan & Durlach 1991]. Changes of the solver's own force between
/// solves do not count as steps of the model. Reference: the same scene, each millisecond, solved
/// to a fifth of the tolerance.
/// A hand that holds cloth and turns it is judged by the torque alike.
/// The rms error is reached at 1 and 5 ms; at 10 and 20 ms only where the hand presses on held
/// cloth. The other values are printed; decision 0015 lists them.
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <functional>
#include <numeric>
#include <vector>

#include "contact/proxy.h"
#include "haptics/probe_tracker.h"
#include "haptics/velocity_filter.h"
#include "support/record.h"
#include "support/scenes.h"
#include "support/smooth.h"
#include "support/tolerance.h"

namespace haptic_cloth::local_model_test {
namespace {

constexpr double kTick = 1e-3;
constexpr double kSpeed = 0.2;      ///< speed of the hand [m/s]
constexpr double kMoving = 0.75;    ///< the hand is down and begins to move [s]
constexpr double kMeasured = 0.82;  ///< end of the start-up; measurement begins [s]
constexpr double kEnd = 1.45;       ///< [s]
constexpr double kMeanTime = 0.1;   ///< length of the running mean [s]

using Path = std::function<Pose(double)>;

/// Strokes of 36 mm to either side at kSpeed, reversed within 0.1 s.
double stroke(double time) {
  constexpr double kTurn = 0.05, kHalf = 0.2;
  const double t = time - kMoving;
  if (t <= 0.0) return 0.0;
  if (t < 1.5 * kTurn) return t < kTurn ? 0.5 * kSpeed * t * t / kTurn : kSpeed * (t - 0.5 * kTurn);
  const auto triangle = [](double s) { return std::abs(std::remainder(s - kHalf, 4.0 * kHalf)) - kHalf; };
  double mean = 0.0;  // the mean over the reversal rounds the corners
  for (int k = -10; k <= 10; ++k) mean += triangle(t - 0.5 * kTurn + k * kTurn / 10.0) / 21.0;
  return -kSpeed * mean;
}

/// Oscillation at 5 Hz with a largest speed of kSpeed.
double beat(double time) {
  const double omega = 2.0 * EIGEN_PI * 5.0;
  return kSpeed / omega * std::sin(omega * std::max(0.0, time - kMoving));
}

struct Case {
  const char* name;
  Scene scene;
  Path path;
  bool grasps = false;  ///< from kGrasp on
};

Scene suiting(double height) {
  Scene scene =
      sheetScene(loadFabric(std::string(HAPTIC_CLOTH_SOURCE_DIR) + "/config/fabrics/winter_suiting.yaml"), 41,
                 41, 0.3, 0.3);
  setStrategy(scene, Strategy::Amrc, 2);
  scene.cloth.pose.position.z() = height;
  scene.air_damping = 0.5;
  return scene;
}

Obstacle box(const Vec3& size, const Vec3& position) {
  Obstacle box;
  box.shape = Shape::Box;
  box.size = size;
  box.pose.position = position;
  box.friction = 0.3;
  return box;
}

/// Cloth over the gap between two tables, held at both ends.
Scene overGap() {
  Scene scene = suiting(0.105);
  scene.obstacles = {box(Vec3(0.1, 0.3, 0.05), Vec3(0.1, 0, 0.07)),
                     box(Vec3(0.1, 0.3, 0.05), Vec3(-0.1, 0, 0.07))};
  pin(scene, 0, 0, 0, 40);
  pin(scene, 40, 40, 0, 40);
  return scene;
}

/// Cloth hung by its corners.
Scene hammock() {
  Scene scene = suiting(0.105);
  for (const int i : {0, 40})
    for (const int j : {0, 40}) pin(scene, i, i, j, j);
  return scene;
}

/// Cloth draped over a box, so that the probe has hard support.
Scene overBox() {
  Scene scene = suiting(0.105);
  scene.obstacles = {box(Vec3(0.15, 0.15, 0.1), Vec3(0, 0, 0.05))};
  return scene;
}

Path moved(const std::function<Vec3(double)>& path) {
  return [path](double time) { return Pose{path(time), Quat::Identity()}; };
}

std::vector<Case> cases() {
  const auto down = [](double t) { return smooth(t, 0.4, 0.7); };
  return {
      {"gap, slid", overGap(), moved([=](double t) { return Vec3(0, stroke(t), 0.13 - 0.05 * down(t)); })},
      {"gap, pressed", overGap(),
       moved([=](double t) { return Vec3(0, 0, 0.13 - 0.062 * down(t) - beat(t)); })},
      {"hammock, slid", hammock(),
       moved([=](double t) { return Vec3(0.01, stroke(t), 0.13 - 0.06 * down(t)); })},
      {"hammock, pressed", hammock(),
       moved([=](double t) { return Vec3(0.01, 0, 0.13 - 0.085 * down(t) - beat(t)); })},
      {"box, slid", overBox(), moved([=](double t) { return Vec3(stroke(t), 0, 0.14 - 0.033 * down(t)); })},
  };
}

/// Hands that hold cloth by a capsule and turn it to and fro around an axis, 20 times as fast in rad/s as the
/// others move in m/s.
std::vector<Case> turnedCases() {
  const auto turned = [](const Vec3& axis, double height) {
    return [=](double t) {
      const Quat along = lyingAlong(Vec3::UnitY());
      return Pose{Vec3(0, 0, 0.13 - height * smooth(t, 0.4, 0.7)), rotationBy(20.0 * beat(t) * axis) * along};
    };
  };
  std::vector<Case> cases = {{"gap, rocked", overGap(), turned(Vec3::UnitX(), 0.05), true},
                             {"gap, rolled", overGap(), turned(Vec3::UnitY(), 0.05), true},
                             {"gap, twisted", overGap(), turned(Vec3::UnitZ(), 0.05), true},
                             {"hammock, rocked", hammock(), turned(Vec3::UnitX(), 0.07), true},
                             {"hammock, twisted", hammock(), turned(Vec3::UnitZ(), 0.07), true}};
  for (Case& drape : cases) drape.scene.probes[0].length = 0.04;
  return cases;
}

/// Results of one solver run, one value per tick.
struct Solved {
  std::vector<ProbeSnapshot> snapshots;
  std::vector<DeviceSample> devices;
  std::vector<Vec3> velocities;  ///< velocities of the proxy [m/s]
  std::vector<Vec3> forces, torques;
};

enum class Role { Snapshots, Reference };

/// Solves as the node does, or to a finer tolerance for the reference.
Solved solve(Case drape, Role role) {
  Scene& scene = drape.scene;
  const bool reference = role == Role::Reference;
  if (reference) {
    scene.solver.minimizer.tolerance *= 0.2;
    scene.solver.minimizer.max_iterations = 2000;
  }
  Simulation simulation(scene);
  VelocityFilter filter(0.005, 0.05), turn_filter(0.005, 0.05);
  ProbeTracker tracker;
  Solved solved;
  for (int k = 1; k * kTick < kEnd; ++k) {
    DeviceSample device;
    device.received = k * kTick;
    const Pose pose = drape.path(device.received), before = drape.path(device.received - kTick);
    const Vec3 moved = pose.position - before.position;
    device.position = pose.position;
    device.velocity = filter.update(moved, false, device.received);
    device.orientation = pose.orientation;
    device.angular_velocity =
        turn_filter.update(turnBetween(before.orientation, pose.orientation), false, device.received);
    simulation.setDevice(0, {pose.position, moved / kTick, pose.orientation, kTick});
    simulation.setGrasp(0, drape.grasps && device.received > kMoving);
    simulation.step();
    const ProbeReport probe = simulation.probe();
    solved.devices.push_back(device);
    solved.velocities.push_back(probe.velocity);
    solved.forces.push_back(probe.force);
    solved.torques.push_back(probe.torque);
    solved.snapshots.push_back(tracker.update(probe, device, kTick, device.received + 0.9 * kTick));
  }
  return solved;
}

/// Extrapolation that the local model has to beat: proxy and velocity, without the device's motion
/// since.
Vec3 plainForce(const HapticOptions& options, const DeviceSample& device, const ProbeSnapshot& snapshot,
                const Vec3& velocity) {
  const double age = std::min(0.02, device.received - snapshot.device_received);
  return options.coupling_stiffness * (snapshot.proxy + age * velocity - device.position) +
         options.coupling_damping * (velocity - device.velocity);
}

/// Plain is, for the torque, that it follows the force at its lever arm.
enum class Rule { Plain, Model, ModelAndController };

struct Ticked {
  std::vector<Vec3> forces, torques;
};

/// Ticks if a snapshot arrives every `interval` ticks.
Ticked ticked(const Solved& solved, int interval, Rule rule) {
  HapticOptions options;
  if (rule != Rule::ModelAndController) options.passivity.damping = options.passivity.debt = 0.0;
  options.soft_start = 0.0;
  options.max_force = options.max_torque = options.max_force_rate = 1e6;
  HapticLoop loop(options);
  Ticked ticked;
  ProbeSnapshot snapshot;
  Vec3 velocity = Vec3::Zero();
  for (int k = 0; k < static_cast<int>(solved.devices.size()); ++k) {
    const DeviceSample& device = solved.devices[k];
    if (k > 0 && (k - 1) % interval == 0) {
      snapshot = solved.snapshots[k - 1];
      velocity = solved.velocities[k - 1];
      if (rule == Rule::Plain) snapshot.turn_radius = 0.0;
    }
    const Vec3 force = loop.tick(device, snapshot, false, device.received);
    ticked.forces.push_back(rule == Rule::Plain ? plainForce(options, device, snapshot, velocity) : force);
    ticked.torques.push_back(loop.torque());
  }
  return ticked;
}

struct Errors {
  double rms = 0.0, largest = 0.0;  ///< relative to the running mean [-]
  double step = 0.0;                ///< largest step at a new snapshot [-]
};

/// @param own force of the run that the snapshots came from; its change in a tick is not a step
Errors errorsOf(const std::vector<Vec3>& forces, const std::vector<Vec3>& reference,
                const std::vector<Vec3>& own, int interval) {
  Errors errors;
  int count = 0;
  const int window = static_cast<int>(kMeanTime / kTick);
  for (int k = static_cast<int>(kMeasured / kTick); k < static_cast<int>(forces.size()); ++k) {
    double mean = 0.0;
    for (int i = k - window + 1; i <= k; ++i) mean += reference[i].norm() / window;
    const double error = (forces[k] - reference[k]).norm() / mean;
    errors.rms += error * error;
    errors.largest = std::max(errors.largest, error);
    ++count;
    if ((k - 1) % interval != 0) continue;
    const Vec3 change = forces[k] - forces[k - 1];
    const double beyond =
        std::min((change - (own[k] - own[k - 1])).norm(), (change - (own[k - 1] - own[k - 2])).norm());
    errors.step = std::max(errors.step, beyond / mean);
  }
  errors.rms = std::sqrt(errors.rms / count);
  return errors;
}

/// Prints errors and checks those of the model, and of the model with the controller.
void expectSmall(const char* name, int interval, const Errors& model, const Errors& plain,
                 const Errors& whole) {
  std::printf(
      "%-16s %2d ms: rms %5.1f %% (plain %5.1f, controller %5.1f), largest %5.1f (%5.1f, %5.1f), step "
      "%5.1f (%5.1f, %5.1f)\n",
      name, interval, 100 * model.rms, 100 * plain.rms, 100 * whole.rms, 100 * model.largest,
      100 * plain.largest, 100 * whole.largest, 100 * model.step, 100 * plain.step, 100 * whole.step);
  EXPECT_LT(model.step, tolerance(0.07)) << interval << " ms";
  if (interval > 5) return;  // they miss 5 % except where cloth is pressed or twisted: decision 0015
  EXPECT_LE(model.rms, tolerance(0.05)) << interval << " ms";
  EXPECT_LE(whole.rms, tolerance(0.05)) << interval << " ms: the controller is felt where nothing buzzes";
}

class LocalModel : public testing::TestWithParam<int> {};

TEST_P(LocalModel, GivesTheSolversForce) {
  const Case drape = cases()[GetParam()];
  const Solved solved = solve(drape, Role::Snapshots);
  const std::vector<Vec3> reference = solve(drape, Role::Reference).forces;
  for (const int interval : {1, 5, 10, 20}) {
    const auto errors = [&](Rule rule) {
      return errorsOf(ticked(solved, interval, rule).forces, reference, solved.forces, interval);
    };
    expectSmall(drape.name, interval, errors(Rule::Model), errors(Rule::Plain),
                errors(Rule::ModelAndController));
  }
}

class LocalTorque : public testing::TestWithParam<int> {};

TEST_P(LocalTorque, IsTheSolvers) {
  const Case drape = turnedCases()[GetParam()];
  const Solved solved = solve(drape, Role::Snapshots), reference = solve(drape, Role::Reference);
  for (const int interval : {1, 5, 10, 20}) {
    const auto errors = [&](Rule rule) {
      return errorsOf(ticked(solved, interval, rule).torques, reference.torques, solved.torques, interval);
    };
    expectSmall(drape.name, interval, errors(Rule::Model), errors(Rule::Plain),
                errors(Rule::ModelAndController));
  }
}

INSTANTIATE_TEST_SUITE_P(Drapes, LocalModel, testing::Range(0, 5));
INSTANTIATE_TEST_SUITE_P(Drapes, LocalTorque, testing::Range(0, 5));

}  // namespace
}  // namespace haptic_cloth::local_model_test
