/// A haptic loop without ROS: one thread steps a cloth, the other drives a device at 1 kHz.
/// The device is simulated: a small mass that a hand presses into the cloth and lifts again.
/// Usage: haptic_loop [--seconds N]    ends with status 0 if a force was felt, within its limit
#include <algorithm>
#include <atomic>
#include <chrono>
#include <cmath>
#include <cstdio>
#include <cstdlib>
#include <string>
#include <thread>

#include "haptic_cloth/haptic_session.h"
#include "haptic_cloth/step_pacer.h"

namespace {

using haptic_cloth::Vec3;
using Clock = std::chrono::steady_clock;

double now() { return std::chrono::duration<double>(Clock::now().time_since_epoch()).count(); }

void sleepUntil(double time) { std::this_thread::sleep_for(std::chrono::duration<double>(time - now())); }

haptic_cloth::Scene makeScene() {
  using haptic_cloth::Curve;
  haptic_cloth::Scene scene;
  haptic_cloth::Fabric& fabric = scene.cloth.fabric;
  fabric.name = "cotton";
  fabric.source = "round numbers for an example";
  fabric.areal_density = 0.15;                                  // kg/m²
  fabric.thickness = 5e-4;                                      // m
  fabric.tensile = {Curve::linear(1000), Curve::linear(1000)};  // N/m
  fabric.bending = {Curve::linear(1e-5), Curve::linear(1e-5)};  // N·m
  fabric.shear = Curve::linear(30);                             // N/m per rad
  scene.cloth.particles = {17, 17};
  scene.cloth.size = {0.16, 0.16};      // m
  scene.cloth.pose.position.z() = 0.0;  // m
  scene.cloth.pins = {{0, 0, 0, 16}, {16, 16, 0, 16}, {0, 16, 0, 0}, {0, 16, 16, 16}};
  scene.probes[0].radius = 0.012;  // m
  scene.solver.threads = 1;        // leaves the other cores to the device
  return scene;
}

/// A device of 0.1 kg in a hand, which holds it like a spring and moves up and down twice a second.
class SimulatedDevice {
 public:
  const Vec3& position() const { return position_; }

  void move(double time, double period, const Vec3& force) {
    const Vec3 hand(0.0, 0.0, 0.025 * std::cos(4.0 * M_PI * time));  // m
    const Vec3 pull = 300.0 * (hand - position_) - 5.0 * velocity_;  // N
    velocity_ += period / 0.1 * (pull + force);
    position_ += period * velocity_;
  }

 private:
  Vec3 position_{0.0, 0.0, 0.025}, velocity_ = Vec3::Zero();
};

}  // namespace

int main(int argc, char** argv) {
  const bool timed = argc == 3 && std::string(argv[1]) == "--seconds";
  const double seconds = timed ? std::atof(argv[2]) : 2.0;
  if ((argc > 1 && !timed) || !(seconds > 0.0)) {
    std::fprintf(stderr, "Usage: haptic_loop [--seconds N]    with N > 0\n");
    return 2;
  }
  const haptic_cloth::HapticOptions options;
  const double period = 1.0 / options.rate;

  haptic_cloth::Simulation simulation(makeScene());
  haptic_cloth::HapticSession session(simulation.scene(), 0, options);
  std::atomic<bool> stop{false};
  std::thread solver([&] {
    haptic_cloth::StepPacer pacer(simulation);
    while (!stop) {
      sleepUntil(pacer.due(now()));
      const int length = pacer.begin(simulation, now());
      session.beforeStep(simulation, now(), length);
      const haptic_cloth::StepReport step = simulation.step(length);
      session.afterStep(simulation, now());
      pacer.end(step, now());
    }
  });

  SimulatedDevice device;
  double largest = 0.0, due = now();  // N, s
  bool good = true;
  for (int tick = 0; tick * period < seconds; ++tick) {
    const Vec3 force = session.tick({device.position()}, now()).force;
    device.move(tick * period, period, force);
    good = good && force.allFinite() && force.norm() <= options.max_force * (1.0 + 1e-9);
    largest = std::max(largest, force.norm());
    if (tick % 100 == 0)
      std::printf("%5.1f s: device %6.1f mm, force %5.2f N\n", tick * period, 1e3 * device.position().z(),
                  force.z());
    due = std::max(due + period, now());  // lost time is not caught up
    sleepUntil(due);
  }
  stop = true;
  solver.join();
  std::printf("largest force %.2f N of %.2f N\n", largest, options.max_force);
  return good && largest > 0.0 ? 0 : 1;
}
