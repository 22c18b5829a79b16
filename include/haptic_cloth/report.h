/// Reports of the solver about a step.
#pragma once

#include <array>
#include <cstdint>
#include <limits>

#include "haptic_cloth/types.h"

namespace haptic_cloth {

/// Why the minimizer stopped.
enum class Termination { Converged, IterationLimit, TimeBudget, LineSearchFailed, NotFinite, OutOfReach };

/// Short name of a termination for logs and files ("converged", ...).
const char* toString(Termination why);

/// Work of the minimizer in one step.
struct MinimizerReport {
  Termination why = Termination::Converged;
  int iterations = 0;
  int evaluations = 0;       ///< evaluations of value and gradient
  int restarts = 0;          ///< search directions reset to the preconditioned gradient
  double value_start = 0.0;  ///< Φ where the last solve of the step starts; 0 if all slept [J]
  double value_end = 0.0;    ///< Φ where it ends; 0 if all slept [J]
  double residual = 0.0;     ///< rms_m(|∇Φ|/m) / |gravity| at the end [-]
  double seconds = 0.0;      ///< wall clock [s]
  /// Share of the motion that was made; below 1 if the cloth might have passed through itself beyond it,
  /// which is Termination::OutOfReach [-].
  double motion_made = 1.0;
};

/// Tells whether a solve has no usable result: it is not finite, or no part of its motion is safe.
inline bool hasFailed(const MinimizerReport& report) {
  return report.why == Termination::NotFinite || report.motion_made == 0.0;
}

/// Energy by kind [J]; that of gravity is zero at the origin of the world.
struct EnergyReport {
  double kinetic = 0.0, gravity = 0.0, stretch = 0.0, bend = 0.0, shear = 0.0, contact = 0.0;
  double coupling = 0.0;    ///< energy of the springs between devices and proxies
  double work = 0.0;        ///< work of devices, obstacles and moving pins since reset
  double dissipated = 0.0;  ///< since reset: initial energy + work - energy now
  double total() const { return kinetic + gravity + stretch + bend + shear + contact + coupling; }
};

/// Violation of each law [J] (docs/model.md: E^n, E^s, E^b, E^h). The condensed cost meets all laws
/// but Newton's exactly, so only `motion` is above zero.
struct CostReport {
  double motion = 0.0, stretch = 0.0, bend = 0.0, shear = 0.0;
  double total() const { return motion + stretch + bend + shear; }
};

/// Result of one step of the simulation.
struct StepReport {
  double time = 0.0;  ///< simulated time at the end of the step [s]
  MinimizerReport minimizer;
  int active_particles = 0;
  int awake_particles = 0;      ///< free particles in the solve; the others sleep
  int refined = 0;              ///< cells split in this step
  int coarsened = 0;            ///< groups of four merged in this step
  bool failed = false;          ///< the last good state was restored
  double velocity_scale = 1.0;  ///< factor of the energy guard for velocities within the cloth; 1: not needed
  double adapt_seconds = 0.0;   ///< wall clock time of mesh adaptation [s]
  double max_penetration = 0.0;  ///< deepest contact sample below an obstacle or the probe [m]
  int self_contacts = 0;         ///< points and lines, by side, that press on another part of the cloth
  /// Smallest distance of parts of the cloth that may meet; infinite if there are none [m].
  double min_self_gap = std::numeric_limits<double>::infinity();
};

/// State of a probe at the end of a step.
struct ProbeReport {
  bool present = false;        ///< the device has given a pose
  Vec3 device = Vec3::Zero();  ///< [m]
  Vec3 proxy = Vec3::Zero();   ///< [m]
  /// Orientation of the proxy. Under a torque it is not quite that of the device.
  Quat orientation = Quat::Identity();
  Vec3 velocity = Vec3::Zero();  ///< velocity of the proxy [m/s]
  /// Radius at which the coupling resists turns [m]; 0: the probe has the orientation of its device.
  double turn_radius = 0.0;
  /// Force of the cloth on the probe; on one that grasps at most what its coupling exerts [N].
  Vec3 force = Vec3::Zero();
  /// Estimate of the force's distance from that of a converged solve on the finest mesh with short
  /// steps [N]. 0 if there was no force in this step and the one before; after a failed step at
  /// least the force that was lost.
  double force_error = 0.0;
  /// Torque of the cloth on the probe about its proxy, with the same limit [N·m].
  Vec3 torque = Vec3::Zero();
  /// A sample of the cloth presses on the probe, or the probe grasps; false after a failed step.
  bool contact = false;
  bool grasps = false;  ///< the probe holds some of the cloth, after a failed step, too
  /// The probe appeared in the cloth, and touches nothing until it has been clear of it once.
  bool inside = false;
  /// Direction in which it then becomes clear of the cloth soonest, of length 1; else zero [-].
  Vec3 way_out = Vec3::Zero();
};

/// Where the cloth passes through itself. Cells are named by their particle (i, j) at the lower left.
struct Crossings {
  int pairs = 0;  ///< pairs of an edge and a triangle of the surface that cut each other
  /// First pair, if there is one: cell of the triangle, cell of the edge, and place [m].
  std::array<int, 2> cell{}, other{};
  Vec3 position = Vec3::Zero();
};

}  // namespace haptic_cloth
