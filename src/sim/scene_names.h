/// Names of choices in scene files, in one table for reading and writing.
#pragma once

#include <string>
#include <utility>
#include <vector>

#include "haptic_cloth/scene.h"

namespace haptic_cloth {

template <class Choice>
using Names = std::vector<std::pair<std::string, Choice>>;

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

inline Names<Shape> shapeNames() {
  return {{"box", Shape::Box},
          {"sphere", Shape::Sphere},
          {"cylinder", Shape::Cylinder},
          {"capsule", Shape::Capsule},
          {"plane", Shape::Plane}};
}

/// Name of a value. @pre the table contains it
template <class Choice>
std::string nameOf(const Names<Choice>& names, Choice value) {
  for (const auto& [name, own] : names) {
    if (own == value) return name;
  }
  return "";
}

}  // namespace haptic_cloth
