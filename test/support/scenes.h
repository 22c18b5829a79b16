/// Scenes shared by tests, benchmarks and validation.
#pragma once

#include <optional>
#include <string>
#include <vector>

#include "haptic_cloth/scene.h"
#include "haptic_cloth/simulation.h"

namespace haptic_cloth {

/// Linear laws for a test. The defaults are a light fabric of 0.15 kg/m².
struct LinearFabric {
  double areal_density = 0.15;          ///< [kg/m²]
  double stiffness = 1000.0;            ///< tension over strain [N/m]
  double compression = 1.0;             ///< stiffness below zero strain / stiffness above [-]
  double rigidity = 0.0;                ///< bending moment over curvature [N·m]
  double shear_modulus = 30.0;          ///< [N/m per rad]
  double thickness = 5e-4;              ///< [m]
  std::optional<Compression> measured;  ///< data of KES-FB3
};

Fabric makeFabric(const LinearFabric& linear);

/// Flat sheet at the origin alone in the world, without air; finest mesh without levels; one
/// thread.
Scene sheetScene(const Fabric& fabric, int warp_particles, int weft_particles, double length, double width);

/// Turns the sheet so that warp hangs straight down from i = 0.
void hangDown(Scene& scene);

/// Pins particles i0..i1 × j0..j1.
void pin(Scene& scene, int i0, int i1, int j0, int j1);
void pinAllSides(Scene& scene);

/// Makes a run reach static equilibrium soon: strong air drag, large steps, no sleep.
void quasiStatic(Scene& scene, double drag, double time_step, double tolerance);

void setStrategy(Scene& scene, Strategy strategy, int levels);
std::string name(Strategy strategy);

/// Square cloth dropped on a box that it overhangs on all sides; amrc, small enough for a quick
/// test.
Scene boxDrape(int particles);

/// Sheet of cells of 2.5 mm, four times as long as wide. Its ends are pinned and driven against each
/// other; they stop there after 0.08 s, and the cloth between hangs in folds; amrc.
Scene foldedSheet(int columns);

/// Weightless strip of finest spacing 2 mm, pinned at both ends, for a frictionless capsule that
/// lies across it and is longer than the strip is wide.
struct CapsuleOnStrip {
  static constexpr double kHalfSpan = 0.08, kWidth = 0.04, kThickness = 2e-4;  ///< of the strip [m]
  static constexpr double kStiffness = 500.0;                                  ///< of the strip [N/m]
  static constexpr double kRadius = 0.01;                                      ///< of the capsule [m]
};
Scene capsuleOnStrip(Strategy strategy);

/// Orientation of a capsule that lies along an axis. (Eigen's function takes a compiler seven seconds.)
Quat lyingAlong(const Vec3& axis);

/// Result of a run until rest.
struct Settled {
  bool at_rest = false;
  int steps = 0;
  int failed_steps = 0;
  int unconverged = 0;           ///< steps that stopped before their tolerance
  double max_penetration = 0.0;  ///< largest value of the run [m]
};

/// Steps until the fastest particle has stayed below `rest_speed` [m/s] for 20 steps, or until
/// `max_time` [s].
/// @param device if given, position at which the device is held [m]
Settled settle(Simulation& simulation, double rest_speed, double max_time, const Vec3* device = nullptr);

/// Position of one finest particle.
Vec3 particle(const Simulation& simulation, int i, int j);

}  // namespace haptic_cloth
