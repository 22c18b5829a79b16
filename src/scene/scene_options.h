/// Rows of the options of a scene, and the names of its choices.
#pragma once

#include <string>
#include <utility>
#include <vector>

#include "haptic_cloth/scene.h"
#include "scene/option.h"

namespace haptic_cloth {

/// Top-level keys of a scene.
inline std::vector<std::string> sceneKeys() {
  return {"cloth", "gravity", "air_damping", "obstacles", "probe", "probes", "solver", "adapt", "stop"};
}

inline Names<Cost> costNames() { return {{"condensed", Cost::Condensed}, {"joint", Cost::Joint}}; }

inline Names<Integrator> integratorNames() {
  return {{"euler", Integrator::Euler}, {"bdf2", Integrator::Bdf2}};
}

inline Names<Preconditioner> preconditionerNames() {
  return {{"multilevel", Preconditioner::Multilevel},
          {"jacobi", Preconditioner::Jacobi},
          {"none", Preconditioner::None}};
}

inline Names<Strategy> strategyNames() {
  return {{"finest", Strategy::Finest},
          {"coarsest", Strategy::Coarsest},
          {"refine", Strategy::Refine},
          {"coarsen", Strategy::Coarsen},
          {"amrc", Strategy::Amrc}};
}

inline Names<StartMesh> startNames() {
  return {{"finest", StartMesh::Finest}, {"coarsest", StartMesh::Coarsest}};
}

Options optionsOf(ClothOptions& cloth);
/// Rows of the motion of a pin.
Options optionsOf(Pin& pin);
Options worldOptions(Scene& scene);
/// Rows of all shapes.
Options optionsOf(Obstacle& obstacle);
Options optionsOf(ProbeOptions& probe);
Options optionsOf(SolverOptions& solver);
Options optionsOf(AdaptOptions& adapt);
Options optionsOf(StopOptions& stop);

/// Options that Simulation::setOptions() takes.
struct StepOptions {
  SolverOptions solver;
  AdaptOptions adapt;
  double air_damping = 0.0;  ///< [1/s]
};

inline StepOptions stepOptions(const Scene& scene) { return {scene.solver, scene.adapt, scene.air_damping}; }

/// Rows with whole keys, such as "solver.tolerance". Those that are not live cannot change.
Options optionsOf(StepOptions& options);

/// Rows of the virtual coupling, which are part of those of a probe.
Options couplingOptions(double& stiffness, double& damping);

/// Rows of the obstacle's own shape.
Options ownOptions(Obstacle& obstacle);

/// Key of a probe: "probe" for the only one, else "probes.NAME" with the given separator.
std::string probeKey(const Scene& scene, const ProbeOptions& probe, char separator = '.');

/// Tables of the reference, with their titles.
std::vector<std::pair<std::string, std::string>> sceneTables();

}  // namespace haptic_cloth
