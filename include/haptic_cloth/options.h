/// Numerical options with their defaults, which scene files, parameters and tests use.
#pragma once

namespace haptic_cloth {

/// Unknowns of a step: positions alone, or positions and forces together as in [M04] (docs/model.md).
enum class Cost { Condensed, Joint };

/// Time integration: backward Euler, or the backward difference formula of second order (BDF2).
enum class Integrator { Euler, Bdf2 };

/// Scaling of the minimizer's directions. `None` still divides by the mass.
enum class Preconditioner { None, Jacobi, Multilevel };

/// Changes that the mesh may make: none from the finest or the coarsest, only splits, only merges, or both.
enum class Strategy { Finest, Coarsest, Refine, Coarsen, Amrc };

/// Mesh of the first step.
enum class StartMesh { Finest, Coarsest };

/// Preconditioner and stopping rules of the minimizer.
struct MinimizerOptions {
  Preconditioner preconditioner = Preconditioner::Multilevel;
  /// The solve stops when rms_m(|∇Φ|/m) <= tolerance · |gravity| [-]; without gravity |gravity|
  /// is 9.80665 m/s².
  double tolerance = 0.1;
  int max_iterations = 1000;  ///< of one solve; most steps need one [-]
  /// Wall clock time from the start of a step to the end of its solve [s]; 0: no limit. At least
  /// one iteration is made, and the best state so far is kept. Work after the solve is not
  /// included.
  double time_budget = 0.0;
};

/// Options of a step and its solve.
struct SolverOptions {
  double time_step = 1e-3;  ///< [s]
  Integrator integrator = Integrator::Euler;
  Cost cost = Cost::Condensed;
  MinimizerOptions minimizer;
  /// Particles slower than this for 50 steps fall asleep [m/s]; 0: none do. They keep their
  /// position until the force on them changes, and cost one evaluation a step.
  double sleep_speed = 3e-4;
  /// Largest number of threads; 0: one for each core, or OMP_NUM_THREADS. The ROS node then leaves one
  /// core to its haptic thread. A step with few particles uses fewer.
  int threads = 0;
};

/// Options of the adaptive mesh.
struct AdaptOptions {
  Strategy strategy = Strategy::Amrc;
  StartMesh start = StartMesh::Finest;  ///< initial mesh of `Amrc`; the other strategies fix theirs
  int levels = 2;                       ///< L: the coarsest cell is 2^L finest cells wide
  int interval = 3;                     ///< time steps between two mesh decisions; a longer step decides once
  double refine_above = 0.70;           ///< cells split above this turning angle at a triple [rad]
  /// Four siblings merge below this turning angle, measured on their parent [rad].
  double coarsen_below = 0.35;
  /// Cells split if tensile strain differs by more than this between their corners [-].
  double refine_above_strain = 0.005;
  /// Four siblings merge if it differs by less than this on their parent [-].
  double coarsen_below_strain = 0.0025;
  /// Factors of these angles and of these strains for cells that are far from all probes, 1 or more [-].
  double far_angle_factor = 1.0, far_strain_factor = 1.0;
  /// Cells within this distance of a probe's finest cells keep the thresholds [spacings of finest particles].
  double near_reach = 8.0;
  /// So do cells, wherever they are, whose tension carries more than this share of the largest force of a
  /// probe, or of the weight of the cloth if that is more [-].
  double near_load = 0.03;
  int minimum_age = 30;  ///< time steps before a new cell may merge; prevents chatter
};

}  // namespace haptic_cloth
