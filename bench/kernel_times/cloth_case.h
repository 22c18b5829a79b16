/// A cloth in mid-drape, and what an iteration does to it, taken apart.
#pragma once

#include <memory>
#include <string>

#include "haptic_cloth/options.h"
#include "sim/cloth_world.h"

namespace haptic_cloth {

/// What one case is made of.
struct CaseOptions {
  std::string strategy, fabric;
  int side = 77;      ///< particles along a side of the finest grid
  double time = 0.2;  ///< simulated before anything is measured [s]
  int threads = 1;
};

/// The box drape after some time: the state that passes are measured on, with all of the cloth awake.
class ClothCase {
 public:
  explicit ClothCase(const CaseOptions& options);

  const CaseOptions& options() const { return options_; }
  ClothWorld& world() { return *world_; }
  const Fabric& fabric() const { return world_->scene.cloth.fabric; }

  /// Unknowns near the last state, as the solver has them, and a direction to look along.
  const Vector& point() const { return point_; }
  const Vector& direction() const { return direction_; }
  const Field& nodes() const { return nodes_; }    ///< the same, by node
  const Field& motion() const { return motion_; }  ///< the direction by node
  const Motion& motionTerms() const { return terms_; }
  Adaptation& adaptation() { return adaptation_; }
  const std::vector<double>& reach() const { return reach_; }
  Vector& scratch() { return scratch_; }
  Field& gradient() { return gradient_; }

  int particles() const { return world_->mesh.active(); }
  int places() const { return world_->mesh.nodes(); }

  struct Iterations {
    int iterations = 0, evaluations = 0;
    double seconds = 0.0, cpu_seconds = 0.0;  ///< wall clock, and what all threads together had of the cores
  };

  /// Whole iterations from the point on, of the cloth.
  Iterations iterate(int iterations);

  /// As many of the minimizer's own vector updates: those of an objective that costs nothing.
  Iterations iterateVectors(int iterations);

 private:
  Iterations minimize(Objective& objective, int iterations);
  void measureUnder();

  CaseOptions options_;
  std::unique_ptr<ClothWorld> world_;
  Adaptation adaptation_;
  std::vector<double> reach_;  ///< as a step has it for a cloth at rest [m]
  Vector point_, direction_, scratch_, start_;
  Field nodes_, motion_, gradient_, start_nodes_, inertial_;
  std::vector<double> mass_, moving_mass_;
  Proxies proxies_;
  Motion terms_{};
};

}  // namespace haptic_cloth
