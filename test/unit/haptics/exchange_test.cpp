/// The three threads of the node without ROS: poses, solver and haptic tick exchange values by
/// mailboxes, while the solver divides its loops over two threads. Criteria: no value is followed
/// by an older one; every force is finite and within max_force; every step is made; no race under
/// the thread sanitizer (scripts/sanitize.sh thread).
#include <gtest/gtest.h>

#include <atomic>
#include <chrono>
#include <cstdlib>
#include <thread>

#include "haptic_cloth/haptic_session.h"
#include "haptic_cloth/haptics.h"
#include "haptic_cloth/simulation.h"
#include "support/scenes.h"

namespace haptic_cloth {
namespace {

constexpr int kSteps = 60;

double steadySeconds() {
  return std::chrono::duration<double>(std::chrono::steady_clock::now().time_since_epoch()).count();
}

/// Shared values, as in the node's SharedProbe.
struct Shared {
  Mailbox<DeviceSample> for_haptics, for_solver;
  Mailbox<ProbeSnapshot> snapshot;
  std::atomic<bool> stop{false}, paused{false};
};

/// Sends poses that move down through the cloth and up again, repeatedly.
void sendPoses(Shared& shared) {
  for (int k = 0; !shared.stop; ++k) {
    DeviceSample sample;
    sample.received = sample.stamp = steadySeconds();
    sample.position = Vec3(0.0, 0.0, 0.012 - 1e-4 * std::abs(k % 400 - 200));
    sample.velocity = Vec3(0.0, 0.0, k % 400 < 200 ? 0.1 : -0.1);
    shared.for_haptics.write(sample);
    shared.for_solver.write(sample);
    shared.paused = k % 500 > 480;
    std::this_thread::sleep_for(std::chrono::microseconds(300));
  }
}

struct SolverResult {
  int failed = 0, backwards = 0;
};

Scene sharedSheet() {
  LinearFabric linear;
  linear.rigidity = 1e-5;
  Scene scene = sheetScene(makeFabric(linear), 33, 33, 0.16, 0.16);
  setStrategy(scene, Strategy::Amrc, 2);
  pinAllSides(scene);
  scene.solver.threads = 2;
  return scene;
}

SolverResult solve(Shared& shared) {
  Simulation simulation(sharedSheet());
  SolverResult result;
  double newest = -1.0;
  for (int step = 0; step < kSteps; ++step) {
    const DeviceSample sample = shared.for_solver.read();
    result.backwards += sample.received < newest;
    newest = sample.received;
    if (sample.received >= 0.0) simulation.setDevice(sample.position, sample.velocity);
    result.failed += simulation.step().failed;
    const ProbeReport probe = simulation.probe();
    ProbeSnapshot snapshot;
    snapshot.taken = steadySeconds();
    snapshot.device_received = sample.received;
    snapshot.device = probe.device;
    snapshot.proxy = probe.proxy;
    snapshot.drift = probe.velocity;
    snapshot.force = probe.force;
    snapshot.contact = probe.contact;
    shared.snapshot.write(snapshot);
  }
  return result;
}

struct HapticResult {
  int ticks = 0, backwards = 0, bad_forces = 0;
};

HapticResult feel(Shared& shared) {
  const HapticOptions options;
  HapticLoop loop(options);
  HapticResult result;
  double newest_pose = -1.0, newest_snapshot = -1.0;
  for (; !shared.stop; ++result.ticks) {
    const DeviceSample& sample = shared.for_haptics.read();
    const ProbeSnapshot& snapshot = shared.snapshot.read();
    result.backwards += sample.received < newest_pose || snapshot.taken < newest_snapshot;
    newest_pose = sample.received;
    newest_snapshot = snapshot.taken;
    const Vec3 force = loop.tick(sample, snapshot, shared.paused, steadySeconds());
    // The factor allows for rounding of the norm.
    result.bad_forces += !(force.norm() <= options.max_force * (1.0 + 1e-12));
    std::this_thread::sleep_for(std::chrono::microseconds(100));
  }
  return result;
}

TEST(Exchange, PosesSolverAndTickShareWithoutLocks) {
  Shared shared;
  HapticResult felt;
  SolverResult solved;
  std::thread poses([&] { sendPoses(shared); });
  std::thread haptics([&] { felt = feel(shared); });
  std::thread solver([&] { solved = solve(shared); });
  solver.join();
  shared.stop = true;
  haptics.join();
  poses.join();
  EXPECT_EQ(solved.failed, 0);
  EXPECT_EQ(solved.backwards + felt.backwards, 0);
  EXPECT_EQ(felt.bad_forces, 0);
  EXPECT_GT(felt.ticks, 0);
}

TEST(Exchange, ASessionSharesWithoutLocks) {
  Simulation simulation(sharedSheet());
  const HapticOptions options;
  HapticSession session(simulation, 0, options);
  std::atomic<bool> stop{false};
  int failed = 0, bad_forces = 0;
  std::thread device([&] {
    for (int k = 0; !stop; ++k) {
      const Pose pose{Vec3(0.0, 0.0, 0.012 - 1e-4 * std::abs(k % 400 - 200)), Quat::Identity()};
      const Vec3 force = session.tick(pose, steadySeconds(), k % 500 > 480).force;
      bad_forces += !(force.norm() <= options.max_force * (1.0 + 1e-12));
      if (k % 50 == 0) session.setGrasp(k % 100 == 0);
      std::this_thread::sleep_for(std::chrono::microseconds(300));
    }
  });
  for (int step = 0; step < kSteps; ++step) {
    if (step == kSteps / 2) {
      simulation.reset();
      session.restart(simulation);
    }
    session.beforeStep(simulation, steadySeconds());
    failed += simulation.step().failed;
    session.afterStep(simulation, steadySeconds());
  }
  stop = true;
  device.join();
  EXPECT_EQ(failed, 0);
  EXPECT_EQ(bad_forces, 0);
}

}  // namespace
}  // namespace haptic_cloth
