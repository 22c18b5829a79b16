/// Scenes shared by tests, benchmarks and examples of validation.
#pragma once

#include <string>
#include <vector>

#include "haptic_cloth/scene.h"
#include "haptic_cloth/simulation.h"

namespace haptic_cloth {

/// Linear laws for a test. Defaults: a light fabric of 0.15 kg/m².
struct LinearFabric {
  double areal_density = 0.15;  ///< [kg/m²]
  double stiffness = 1000.0;    ///< tension over strain [N/m]
  double compression = 1.0;     ///< stiffness below zero strain over that above [-]
  double rigidity = 0.0;        ///< bending moment over curvature [N·m]
  double shear_modulus = 30.0;  ///< [N/m per rad]
  double thickness = 5e-4;      ///< [m]
};

Fabric makeFabric(const LinearFabric& linear);

/// A flat sheet at the origin, nothing else in the world, no air; finest mesh without levels; one thread.
Scene sheetScene(const Fabric& fabric, int warp_particles, int weft_particles, double length, double width);

/// Turns the sheet so that warp hangs straight down from i = 0.
void hangDown(Scene& scene);

/// Pins particles i0..i1 x j0..j1.
void pin(Scene& scene, int i0, int i1, int j0, int j1);
void pinAllSides(Scene& scene);

/// Makes a run end in a static equilibrium soon: strong air drag and large steps; nothing sleeps on the way.
void quasiStatic(Scene& scene, double drag, double time_step, double tolerance);

void setStrategy(Scene& scene, Strategy strategy, int levels);
std::string name(Strategy strategy);

/// A square cloth dropped on a box that it overhangs on all sides, amrc, the size of a quick test.
Scene boxDrape(int particles);

/// What a settled run looked like.
struct Settled {
  bool at_rest = false;
  int steps = 0;
  int failed_steps = 0;
  int unconverged = 0;           ///< steps that ended short of their tolerance
  double max_penetration = 0.0;  ///< over the run [m]
};

/// Steps until the fastest particle has stayed below `rest_speed` [m/s] for 20 steps or `max_time` [s] has
/// passed. If `device` is given, it is held there.
Settled settle(Simulation& simulation, double rest_speed, double max_time, const Vec3* device = nullptr);

/// Position of one finest particle.
Vec3 particle(const Simulation& simulation, int i, int j);

}  // namespace haptic_cloth
