#include "stability/closed_loop.h"

#include <algorithm>
#include <cmath>
#include <random>
#include <vector>

#include "haptics/velocity_filter.h"
#include "stability/loop_parts.h"

namespace haptic_cloth {
namespace {

/// Range of a vector over time.
struct Range {
  Vec3 low = Vec3::Constant(1e9), high = Vec3::Constant(-1e9);
  void add(const Vec3& value) {
    low = low.cwiseMin(value);
    high = high.cwiseMax(value);
  }
  double half() const { return 0.5 * (high - low).maxCoeff(); }
};

/// Finds the motion about the straight line that fits the places best, which are a step apart.
void measureMotion(const std::vector<Vec3>& places, LoopResult& result) {
  const auto count = static_cast<double>(places.size());
  const auto time = [&](std::size_t k) { return kStep * (static_cast<double>(k) - 0.5 * (count - 1.0)); };
  Vec3 velocity = Vec3::Zero();
  for (std::size_t k = 0; k < places.size(); ++k) velocity += time(k) * places[k];
  velocity *= 12.0 / (kStep * kStep * count * (count * count - 1.0));
  Range range;
  for (std::size_t k = 0; k < places.size(); ++k) range.add(places[k] - time(k) * velocity);
  result.amplitude = range.half();
  result.drift = velocity.norm();
}

Vec3 targetAt(const HandModel& hand, double time, Vec3& velocity) {
  const double s = std::clamp((time - hand.press_from) / hand.press_time, 0.0, 1.0);
  velocity = 6.0 * s * (1.0 - s) / hand.press_time * (hand.pressed - hand.start);
  return hand.start + s * s * (3.0 - 2.0 * s) * (hand.pressed - hand.start);
}

/// Makes one step of the mechanism in the hand.
void moveDevice(const LoopRun& run, double time, const Vec3& force, Vec3& position, Vec3& velocity) {
  Vec3 target_velocity;
  const Vec3 target = targetAt(run.hand, time, target_velocity);
  const Vec3 hand =
      run.hand.stiffness * (target - position) + run.hand.damping * (target_velocity - velocity);
  velocity += kStep / run.device.mass * (force + hand - run.device.damping * velocity);
  position += kStep * velocity;
}

}  // namespace

ProbeReport WallWorld::solve(const Vec3& device, const Vec3& device_velocity) {
  constexpr double kTimeStep = 1e-3;
  ProbeReport report;
  report.present = true;
  report.device = report.proxy = device;
  report.contact = device.z() < 0.0;
  if (report.contact) report.proxy.z() = follow_ * device.z();
  if (known_) report.velocity = (report.proxy - proxy_) / kTimeStep;
  known_ = true;
  proxy_ = report.proxy;
  if (report.contact)
    report.force = coupling_ * (report.proxy - device) + damping_ * (report.velocity - device_velocity);
  return report;
}

LoopResult runLoop(const LoopRun& run, ProbeWorld& world) {
  const int steps_per_tick = static_cast<int>(std::lround(1.0 / (run.options.rate * kStep)));
  HapticLoop loop(run.options);
  VelocityFilter filter(run.options.velocity_time_constant, run.options.pose_timeout);
  SolverThread solver(run.solver, world);
  DelayLine way_in(0.5 * run.device.delay), way_out(0.5 * run.device.delay);
  std::mt19937 random(1);
  std::uniform_real_distribution<double> noise(-run.device.noise, run.device.noise);
  Vec3 position = run.hand.start, velocity = Vec3::Zero(), force = Vec3::Zero();
  DeviceSample sample;
  ProbeSnapshot snapshot;
  LoopResult result;
  std::vector<Vec3> path;
  Range forces;
  Vec3 sum = Vec3::Zero();
  const int steps = static_cast<int>(std::lround(run.time / kStep));
  for (int k = 0; k < steps; ++k) {
    const double time = k * kStep;
    const bool late = time < run.device.late_until;
    const Vec3 delayed = way_in.pass(position), seen = late ? delayed : position;
    if (k % steps_per_tick == 0) {
      if (time < run.device.dies_at) {
        const DeviceSample before = sample;
        sample.received = time;
        for (int c = 0; c < 3; ++c)
          sample.position[c] =
              run.device.quantum * std::floor((seen[c] + noise(random)) / run.device.quantum);
        sample.velocity = filter.update(sample.position - before.position, false, time);
      }
      solver.run(time, sample, snapshot);
      const Vec3 before = force;
      force = loop.tick(sample, snapshot, false, time);
      result.finite = result.finite && force.allFinite();
      result.most_force = std::max(result.most_force, force.norm());
      result.most_change = std::max(result.most_change, (force - before).norm());
      if (!force.isZero(0.0))
        result.zero_since = 1e9;
      else
        result.zero_since = std::min(result.zero_since, time);
    }
    const Vec3 delayed_force = way_out.pass(force), felt = late ? delayed_force : force;
    moveDevice(run, time, felt, position, velocity);
    if (time >= run.time - run.measured) {
      path.push_back(position);
      forces.add(felt);
      sum += felt;
      result.generated += felt.dot(velocity) * kStep;
    }
  }
  measureMotion(path, result);
  result.force_ripple = forces.half();
  result.mean_force = sum.norm() * kStep / run.measured;
  result.force_at_end = force.norm();
  return result;
}

std::vector<PublishedDevice> publishedDevices() {
  return {{"touch", 3.3, 400.0, 4.0, 0.05, 5.5e-5},
          {"omni", 3.3, 700.0, 5.0, 0.05, 5.5e-5},
          {"premium", 8.5, 800.0, 5.0, 0.075, 3e-5},
          {"omega", 12.0, 5000.0, 30.0, 0.2, 1e-5},
          {"falcon", 8.0, 3000.0, 15.0, 0.25, 6e-5}};
}

}  // namespace haptic_cloth
