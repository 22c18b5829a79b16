/// What the solver says of its work.
#pragma once

#include <cstdint>

#include "haptic_cloth/types.h"

namespace haptic_cloth {

/// Why the minimizer stopped.
enum class Termination { Converged, IterationLimit, TimeBudget, LineSearchFailed, NotFinite };

/// Short name of a termination for logs and files ("converged", ...).
const char* toString(Termination why);

/// Work of the minimizer in one step.
struct MinimizerReport {
  Termination why = Termination::Converged;
  int iterations = 0;
  int evaluations = 0;       ///< of value and gradient
  int restarts = 0;          ///< directions reset to the preconditioned gradient
  double value_start = 0.0;  ///< Φ [J]
  double value_end = 0.0;    ///< [J]
  double residual = 0.0;     ///< rms_m(|∇Φ|/m) / |gravity| at the end [-]
  double seconds = 0.0;      ///< wall clock [s]
};

/// Energy by kind [J]; gravity counts from z = 0 of the world along -gravity.
struct EnergyReport {
  double kinetic = 0.0, gravity = 0.0, stretch = 0.0, bend = 0.0, shear = 0.0, contact = 0.0;
  double coupling = 0.0;    ///< spring between device and proxy
  double work = 0.0;        ///< since reset: of devices and obstacles; pins do none
  double dissipated = 0.0;  ///< since reset: initial energy + work - energy now
  double total() const { return kinetic + gravity + stretch + bend + shear + contact + coupling; }
};

/// How far each law is from being met [J] (docs/model.md: E^n, E^s, E^b, E^h). The condensed cost meets all
/// laws but Newton's exactly, so only `motion` is above zero.
struct CostReport {
  double motion = 0.0, stretch = 0.0, bend = 0.0, shear = 0.0;
  double total() const { return motion + stretch + bend + shear; }
};

/// Result of one step of the simulation.
struct StepReport {
  double time = 0.0;  ///< simulated, at the end of the step [s]
  MinimizerReport minimizer;
  int active_particles = 0;
  int awake_particles = 0;       ///< free ones that took part in the solve; the others sleep
  int refined = 0;               ///< cells split in this step
  int coarsened = 0;             ///< groups of four merged in this step
  bool failed = false;           ///< the last good state was restored
  double velocity_scale = 1.0;   ///< by the energy guard; 1: nothing to do
  double adapt_seconds = 0.0;    ///< wall clock of following the shape with the mesh [s]
  double max_penetration = 0.0;  ///< deepest contact sample below an obstacle or the probe [m]
};

/// The probe at the end of a step.
struct ProbeReport {
  bool present = false;          ///< the device has given a pose
  Vec3 device = Vec3::Zero();    ///< [m]
  Vec3 proxy = Vec3::Zero();     ///< [m]
  Vec3 velocity = Vec3::Zero();  ///< of the proxy [m/s]
  Vec3 force = Vec3::Zero();     ///< on the probe, by the cloth [N]
  Vec3 torque = Vec3::Zero();    ///< on the probe about its proxy, by the cloth [N·m]
  bool contact = false;          ///< some sample of the cloth presses on the probe, or it grasps
  bool grasps = false;           ///< it holds some of the cloth
};

}  // namespace haptic_cloth
