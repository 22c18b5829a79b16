/// Force on a hand that holds cloth while steps of the solver come late. Tick and solver share one thread
/// and an artificial clock, so the lateness is exact. Reference: the same motion with a step each
/// millisecond.
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <cstdio>
#include <functional>
#include <ostream>
#include <string>
#include <vector>

#include "haptic_cloth/haptic_session.h"
#include "haptic_cloth/step_pacer.h"
#include "support/tolerance.h"

namespace haptic_cloth::held_cloth_test {
namespace {

constexpr double kTick = 1e-3;  ///< [s]

/// When steps end, and how long they are.
struct Solver {
  std::string name;
  std::function<double(int)> duration;  ///< wall-clock time of a step, by its number [s]
  bool keeps_clock = true;              ///< steps as StepPacer plans them; false: as long as they take
};

/// For messages of gtest.
void PrintTo(const Solver& solver, std::ostream* out) { *out << solver.name; }

/// Steps that all take so many ticks and are as long, at full quality.
Solver late(int ticks) {
  return {"Late" + std::to_string(ticks), [=](int) { return ticks * kTick; }, false};
}

/// Steps that take a tick, but one of `steps` is interrupted.
Solver stalled(int ticks, int steps) {
  return {"Stalled" + std::to_string(ticks),
          [=](int step) { return step % steps == steps - 1 ? ticks * kTick : kTick; }};
}

Scene fold() {
  Scene scene = loadScene(std::string(HAPTIC_CLOTH_SOURCE_DIR) + "/config/scenes/fold.yaml");
  scene.solver.threads = 1;
  return scene;
}

/// Forces of the ticks until `end` [s] for a hand on the path of the scene's probe [N].
std::vector<Vec3> felt(const Scene& scene, const Solver& solver, double end) {
  const ProbeOptions& probe = scene.probes[0];
  Simulation simulation(scene);
  HapticSession session(scene, 0);
  StepPacer pacer(simulation);
  StepReport report;
  std::vector<Vec3> forces;
  int steps = 0;
  bool solving = false;
  double done = 0.0;
  for (int k = 1; k * kTick < end; ++k) {
    const double now = k * kTick;
    if (solving && now >= done - 0.5 * kTick) {
      session.afterStep(simulation, now);
      if (solver.keeps_clock) pacer.end(report, now);
      solving = false;
    }
    session.setGrasp(std::any_of(probe.grasp.begin(), probe.grasp.end(),
                                 [&](const auto& times) { return times[0] <= now && now < times[1]; }));
    forces.push_back(session.tick({pathPosition(probe.path, now)}, now).force);
    if (solving || (solver.keeps_clock && pacer.due(now) > now)) continue;
    const double duration = solver.duration(steps++);
    const int length = solver.keeps_clock ? pacer.begin(simulation, now)
                                          : static_cast<int>(std::lround(duration / scene.solver.time_step));
    session.beforeStep(simulation, now, length);
    report = simulation.step(length);
    solving = true;
    done = now + duration;
  }
  EXPECT_EQ(session.grasp(), GraspState::Holding);
  return forces;
}

double largest(const std::vector<Vec3>& forces, double from) {
  double largest = 0.0;
  for (int k = static_cast<int>(from / kTick); k < static_cast<int>(forces.size()); ++k)
    largest = std::max(largest, forces[k].norm());
  return largest;
}

constexpr double kLifted = 1.05, kCarried = 3.3;  ///< when the corner leaves the table, and is held high [s]

/// Largest force on the hand that carries a corner, with a step each tick [N].
double exactly() {
  static const double force = largest(felt(fold(), late(1), kCarried), kLifted);
  return force;
}

class LateSolver : public testing::TestWithParam<Solver> {};

// A corner is taken from a table, lifted and carried. In a tick light cloth may add 5 % of max_force to the
// force of the newest solve (coupling_model.h). As much again is left for that solve: after a late step the
// hand in it is up to twice as fast. Without a model of what is held these hands felt 0.5 to 1.2 N.
TEST_P(LateSolver, LetsLiftedClothStayLight) {
  const double exact = exactly(), force = largest(felt(fold(), GetParam(), kCarried), kLifted);
  std::printf("%s: %.3f N, with a step each tick %.3f N\n", GetParam().name.c_str(), force, exact);
  EXPECT_GT(exact, 0.02);  // the weight of a fifth of the cloth: it is held
  EXPECT_LT(force, tolerance(exact + 2.0 * 0.05 * HapticOptions().max_force));
}

INSTANTIATE_TEST_SUITE_P(Steps, LateSolver,
                         testing::Values(late(30), late(40), stalled(50, 20), stalled(90, 50)),
                         [](const auto& info) { return info.param.name; });

// Cloth that is pinned at one side and pulled at the other, by 6.3 mm at 5 Hz, a speed of 0.2 m/s. Criterion:
// rms error 5 % of the rms force, as for a touching probe with snapshots every 5 ms (local_model_test.cpp).
TEST(TautCloth, IsAsStiffWithLaterSteps) {
  constexpr double kTaut = 1.5, kMeasured = 1.7, kEnd = 2.7;  // [s]
  Scene scene = fold();
  scene.cloth.pins = {{0, 0, 0, 48}};
  scene.probes[0].path = {{0.0, {0.094, 0, 0.085}}, {0.5, {0.094, 0, 0.059}}, {0.7, {0.094, 0, 0.056}},
                          {1.0, {0.094, 0, 0.056}}, {1.3, {0.090, 0, 0.075}}, {kTaut, {0.097, 0, 0.075}}};
  for (double t = kTaut + 0.005; t < kEnd + 0.01; t += 0.005) {
    const double pull = 0.0063 * std::sin(2.0 * EIGEN_PI * 5.0 * (t - kTaut));
    scene.probes[0].path.push_back({t, {0.097 + pull, 0, 0.075}});
  }
  const std::vector<Vec3> exact = felt(scene, late(1), kEnd), forces = felt(scene, late(4), kEnd);
  double errors = 0.0, squares = 0.0;
  for (int k = static_cast<int>(kMeasured / kTick); k < static_cast<int>(exact.size()); ++k) {
    errors += (forces[k] - exact[k]).squaredNorm();
    squares += exact[k].squaredNorm();
  }
  EXPECT_GT(largest(exact, kMeasured), 1.0);  // taut
  EXPECT_LT(std::sqrt(errors / squares), tolerance(0.05));
}

}  // namespace
}  // namespace haptic_cloth::held_cloth_test
