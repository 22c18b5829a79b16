/// Numerical options, each default in this one place. Scene files, parameters and tests refer to these.
#pragma once

namespace haptic_cloth {

/// Unknowns of a step: positions alone, or positions and forces together as in [M04] (docs/model.md).
enum class Cost { Condensed, Joint };

/// Scaling of the minimizer's directions. `None` still divides by the mass.
enum class Preconditioner { None, Jacobi, Multilevel };

/// Changes that the mesh may make: none from the finest or the coarsest, only splits, only merges, or both.
enum class Strategy { Finest, Coarsest, Refine, Coarsen, Amrc };

/// Mesh of the first step.
enum class StartMesh { Finest, Coarsest };

/// When the minimizer stops, and what it may cost.
struct MinimizerOptions {
  Preconditioner preconditioner = Preconditioner::Multilevel;
  double tolerance =
      0.1;  ///< stop when rms_m(|∇Φ|/m) <= tolerance · |gravity| (9.80665 m/s² where there is none)  [-]
  int max_iterations = 200;  ///< [-]
  double time_budget = 0.0;  ///< wall clock of one step [s], but one iteration at least; 0: none. The best
                             ///< state so far is kept. What follows the solve comes on top.
};

/// How a step is made.
struct SolverOptions {
  double time_step = 1e-3;  ///< [s]
  Cost cost = Cost::Condensed;
  MinimizerOptions minimizer;
  double sleep_speed = 3e-4;  ///< particles slower than this for 50 steps stay where they are until the force
                              ///< on them changes, and cost one look a step [m/s]; 0: none
  int threads = 0;            ///< at most; 0: as many as there are cores, of which the node leaves
                              ///< one to its haptic thread. A step takes fewer where particles are few
};

/// How the mesh follows the shape.
struct AdaptOptions {
  Strategy strategy = Strategy::Amrc;
  StartMesh start = StartMesh::Finest;  ///< mesh that `Amrc` begins with; the others begin as they must
  int levels = 2;                       ///< L: the coarsest cell is 2^L finest cells wide
  int interval = 3;                     ///< steps between two looks at the mesh
  double refine_above = 0.60;           ///< turning angle at a triple above which its cells split [rad]
  double coarsen_below = 0.30;  ///< turning angle below which four siblings merge, as on their parent [rad]
  double refine_above_strain = 0.005;  ///< cells split where tensile strain differs more between corners [-]
  double coarsen_below_strain = 0.0025;  ///< siblings merge where it differs less, as on their parent [-]
  int minimum_age = 30;  ///< steps a new cell stays as it is before it may merge; against chatter
};

}  // namespace haptic_cloth
