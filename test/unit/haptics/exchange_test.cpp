/// The three threads of the node without ROS: poses, solver and haptic tick exchange values by
/// mailboxes, while the solver divides its loops over two threads. Criteria: no value is followed
/// by an older one; every force is finite and within max_force, every tool in its workspace; every
/// step is made; no race under the thread sanitizer (scripts/sanitize.sh thread).
#include <gtest/gtest.h>

#include <atomic>
#include <chrono>
#include <cstdlib>
#include <thread>

#include "haptic_cloth/haptic_session.h"
#include "haptic_cloth/haptics.h"
#include "haptic_cloth/simulation.h"
#include "support/scenes.h"

namespace haptic_cloth::exchange_test {
namespace {

constexpr int kSteps = 60;

double steadySeconds() {
  return std::chrono::duration<double>(std::chrono::steady_clock::now().time_since_epoch()).count();
}

/// Path of the device: down through the cloth and up again, repeatedly. It creeps along x, which tells
/// poses apart.
Pose poseAt(int k) { return {Vec3(1e-7 * k, 0.0, 0.012 - 1e-4 * std::abs(k % 400 - 200)), Quat::Identity()}; }

bool pausedAt(int k) { return k % 500 > 480; }

/// The factor allows for rounding of the norm.
bool isBad(const Vec3& force, const HapticOptions& options) {
  return !(force.norm() <= options.max_force * (1.0 + 1e-12));
}

Scene sharedSheet() {
  LinearFabric linear;
  linear.rigidity = 1e-5;
  Scene scene = sheetScene(makeFabric(linear), 33, 33, 0.16, 0.16);
  setStrategy(scene, Strategy::Amrc, 2);
  pinAllSides(scene);
  scene.solver.threads = 2;
  return scene;
}

/// Poses as another thread receives them, with the session they go to.
struct Loop {
  struct Received {
    double when = -1.0;
    Pose pose;
  };
  Simulation simulation{sharedSheet()};
  HapticSession session{simulation.scene(), 0};
  Mailbox<Received> poses;
  std::atomic<bool> stop{false}, paused{false};

  void sendPoses() {
    for (int k = 0; !stop; ++k) {
      poses.write({steadySeconds(), poseAt(k)});
      paused = pausedAt(k);
      std::this_thread::sleep_for(std::chrono::microseconds(300));
    }
  }
};

struct SolverResult {
  int failed = 0, backwards = 0, present = 0;
};

SolverResult solve(Loop& loop) {
  SolverResult result;
  double newest = 0.0;
  for (int step = 0; step < kSteps; ++step) {
    if (step == kSteps / 2) {
      loop.simulation.reset();
      loop.session.restart(loop.simulation);
    }
    loop.session.beforeStep(loop.simulation, steadySeconds());
    result.failed += loop.simulation.step().failed;
    loop.session.afterStep(loop.simulation, steadySeconds());
    if (!loop.session.isPresent()) continue;
    ++result.present;
    const double x = loop.simulation.probe().device.x();
    result.backwards += x < newest;
    newest = x;
  }
  return result;
}

struct HapticResult {
  int ticks = 0, backwards = 0, bad_forces = 0;
};

HapticResult feel(Loop& loop) {
  HapticResult result;
  double newest = -1.0;
  for (; !loop.stop; ++result.ticks) {
    const Loop::Received& received = loop.poses.read();
    result.backwards += received.when < newest;
    newest = received.when;
    loop.session.setPose(received.pose, received.when);
    const Vec3 force = loop.session.tick(steadySeconds(), loop.paused).force;
    result.bad_forces += isBad(force, loop.session.options());
    if (result.ticks % 50 == 0) {
      HapticOptions options = loop.session.options();
      options.coupling_stiffness = result.ticks % 100 == 0 ? 300.0 : 400.0;
      loop.session.setOptions(options);
    }
    std::this_thread::sleep_for(std::chrono::microseconds(100));
  }
  return result;
}

TEST(Exchange, PosesSolverAndTickShareWithoutLocks) {
  Loop loop;
  HapticResult felt;
  SolverResult solved;
  std::thread poses([&] { loop.sendPoses(); });
  std::thread haptics([&] { felt = feel(loop); });
  std::thread solver([&] { solved = solve(loop); });
  std::thread grasps([&] {
    for (int k = 0; !loop.stop; ++k) {
      loop.session.setGrasp(k % 2 == 0);
      std::this_thread::sleep_for(std::chrono::milliseconds(15));
    }
  });
  solver.join();
  loop.stop = true;
  haptics.join();
  poses.join();
  grasps.join();
  EXPECT_EQ(solved.failed, 0);
  EXPECT_EQ(solved.backwards + felt.backwards, 0);
  EXPECT_EQ(felt.bad_forces, 0);
  EXPECT_GT(solved.present, 0) << "nothing was exchanged";
  EXPECT_GT(felt.ticks, 0);
}

TEST(Exchange, AnAdmittanceSessionSharesWithoutLocks) {
  Simulation simulation(sharedSheet());
  AdmittanceSession session(simulation.scene(), 0);
  const AdmittanceOptions tool = session.options().admittance;
  std::atomic<bool> stop{false};
  int failed = 0, outside = 0, moves = 0;
  std::thread device([&] {
    Vec3 last = tool.start;
    for (int k = 0; !stop; ++k) {
      const Pose pose =
          session.tick(Vec3(0.0, 0.0, k % 400 < 200 ? -3.0 : 3.0), steadySeconds(), pausedAt(k));
      const auto beyond = (pose.position - tool.workspace_low).cwiseMin(tool.workspace_high - pose.position);
      outside += !(beyond.minCoeff() >= 0.0);
      moves += pose.position != last;
      last = pose.position;
      std::this_thread::sleep_for(std::chrono::microseconds(300));
    }
  });
  for (int step = 0; step < kSteps; ++step) {
    session.beforeStep(simulation, steadySeconds());
    failed += simulation.step().failed;
    session.afterStep(simulation, steadySeconds());
  }
  stop = true;
  device.join();
  EXPECT_EQ(failed, 0);
  EXPECT_EQ(outside, 0);
  EXPECT_GT(moves, 0) << "no snapshot arrived";
}

}  // namespace
}  // namespace haptic_cloth::exchange_test
