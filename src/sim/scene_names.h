/// The words by which scene files choose: one table for those who read them and those who write them.
#pragma once

#include <string>
#include <utility>
#include <vector>

#include "haptic_cloth/scene.h"

namespace haptic_cloth {

template <class Choice>
using Names = std::vector<std::pair<std::string, Choice>>;

/// The keys at the top of a scene.
inline std::vector<std::string> sceneKeys() {
  return {"cloth", "gravity", "air_damping", "obstacles", "probe", "probes", "solver", "adapt", "stop"};
}

inline Names<Cost> costNames() { return {{"condensed", Cost::Condensed}, {"joint", Cost::Joint}}; }

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

/// @pre the value is among them
template <class Choice>
std::string nameOf(const Names<Choice>& names, Choice value) {
  for (const auto& [name, own] : names) {
    if (own == value) return name;
  }
  return "";
}

}  // namespace haptic_cloth
