/// Cloth at rest sleeps.
/// Criteria: it ends where it would without sleep, within what rest may hide: a particle sleeps when it was
/// slower than v = 0.3 mm/s for 50 steps, so accelerations below v/(50 h) = 0.6 mm/s² = 6e-4 g are lost;
/// asleep it takes no iteration; touched, it answers as if it had never slept.
#include <gtest/gtest.h>

#include <cmath>

#include "support/record.h"
#include "support/scenes.h"
#include "support/tolerance.h"

namespace haptic_cloth {
namespace {

/// A suiting held by two sides: it sags, and its hysteresis brings it to rest.
Scene sagging(double sleep_speed) {
  Scene scene = sheetScene(loadFabric(HAPTIC_CLOTH_SOURCE_DIR "/config/fabrics/winter_suiting.yaml"), 33, 33,
                           0.16, 0.16);
  pin(scene, 0, 0, 0, 32);
  pin(scene, 32, 32, 0, 32);
  setStrategy(scene, Strategy::Amrc, 2);
  scene.air_damping = 5.0;
  scene.probes[0].radius = 0.01;
  scene.solver.sleep_speed = sleep_speed;
  return scene;
}

void run(Simulation& simulation, double seconds) {
  for (const double end = simulation.time() + seconds; simulation.time() < end;) simulation.step();
}

/// Comes down in the middle within 0.1 s, as far as 4 mm below where the cloth hangs. @return force on it [N]
Vec3 press(Simulation& simulation) {
  const double top = particle(simulation, 16, 16).z() + 0.0115;
  for (int step = 0; step < 150; ++step) {
    const double down = std::min(1.0, step / 100.0);
    simulation.setDevice(Vec3(0.0, 0.0, top - 0.0155 * down), Vec3(0.0, 0.0, step < 100 ? -0.155 : 0.0));
    simulation.step();
  }
  return simulation.probe().force;
}

double rms(const Simulation& a, const Simulation& b) {
  std::vector<Vec3> x, y;
  a.positions(x);
  b.positions(y);
  double sum = 0.0;
  for (std::size_t p = 0; p < x.size(); ++p) sum += (x[p] - y[p]).squaredNorm();
  return std::sqrt(sum / x.size());
}

TEST(Rest, SleepsWhereItWouldRestAndWakesWhenTouched) {
  Simulation awake(sagging(0.0)), sleeper(sagging(3e-4));
  run(awake, 2.0);
  run(sleeper, 2.0);
  EXPECT_GT(-particle(awake, 16, 16).z(), 0.005) << "nothing sagged";
  EXPECT_EQ(sleeper.maxSpeed(), 0.0);
  record({"sleep", "rms distance from the shape without sleep [m]", "amrc", 0.0, rms(awake, sleeper), 0.0,
          0.16});
  EXPECT_LT(rms(awake, sleeper), tolerance(1e-3 * 0.16));

  const StepReport asleep = sleeper.step();
  EXPECT_EQ(asleep.minimizer.iterations + asleep.minimizer.evaluations, 0);
  EXPECT_EQ(asleep.awake_particles, 0);

  const Vec3 expected = press(awake), felt = press(sleeper);
  EXPECT_GT(expected.z(), 0.02);
  record({"sleep", "force on a probe that wakes it [N]", "amrc", 0.0, felt.z(), expected.z(), expected.z()});
  EXPECT_NEAR(felt.z(), expected.z(), tolerance(0.03 * expected.z()));
}

TEST(Rest, FreeFallNeverSleeps) {
  Scene scene = sagging(3e-4);
  scene.cloth.pins.clear();
  scene.air_damping = 0.0;
  Simulation simulation(scene);
  for (int step = 0; step < 100; ++step) simulation.step();
  const double h = scene.solver.time_step;
  EXPECT_NEAR(particle(simulation, 16, 16).z(), -9.81 * h * h * 100 * 101 / 2, tolerance(1e-9));
}

}  // namespace
}  // namespace haptic_cloth
