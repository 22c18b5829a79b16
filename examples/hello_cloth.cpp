/// A square of cloth pinned on all sides, a probe that is pressed into its middle, and the force on
/// the hand.
#include <cstdio>

#include "haptic_cloth/simulation.h"

namespace {

haptic_cloth::Scene makeScene() {
  using haptic_cloth::Curve;
  haptic_cloth::Fabric fabric;
  fabric.name = "cotton";
  fabric.source = "round numbers for an example";
  fabric.areal_density = 0.15;                                  // kg/m²
  fabric.thickness = 5e-4;                                      // m
  fabric.tensile = {Curve::linear(1000), Curve::linear(1000)};  // N/m
  fabric.bending = {Curve::linear(1e-5), Curve::linear(1e-5)};  // N·m
  fabric.shear = Curve::linear(30);                             // N/m per rad

  haptic_cloth::Scene scene;
  scene.cloth.fabric = fabric;
  scene.cloth.particles = {33, 33};
  scene.cloth.size = {0.2, 0.2};        // m
  scene.cloth.pose.position.z() = 0.0;  // m
  scene.cloth.pins = {{0, 0, 0, 32}, {32, 32, 0, 32}, {0, 32, 0, 0}, {0, 32, 32, 32}};
  scene.probes[0].radius = 0.01;  // m
  return scene;
}

}  // namespace

int main() {
  haptic_cloth::Simulation simulation(makeScene());
  const double step = simulation.scene().solver.time_step;
  const double speed = -0.1;  // m/s, downwards
  double height = 0.02;       // m, of the device

  int failed = 0;
  while (simulation.time() < 0.3) {
    height += speed * step;
    simulation.setDevice({0.0, 0.0, height}, {0.0, 0.0, speed});
    failed += simulation.step().failed ? 1 : 0;
  }

  const haptic_cloth::ProbeReport probe = simulation.probe();
  std::printf("device %.1f mm, probe %.1f mm, force on the hand %.3f N, %d of %d particles active\n",
              1e3 * probe.device.z(), 1e3 * probe.proxy.z(), probe.force.z(), simulation.activeParticles(),
              33 * 33);
  const bool good = failed == 0 && probe.contact && probe.force.z() > 0.0 && probe.force.z() < 10.0;
  return good ? 0 : 1;
}
