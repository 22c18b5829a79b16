/// A cloth in the middle of a drape, and the parts of an iteration on it.
#pragma once

#include <memory>
#include <string>

#include "haptic_cloth/options.h"
#include "sim/cloth_world.h"
#include "solver/minimizer.h"

namespace haptic_cloth {

/// Options of one case.
struct CaseOptions {
  std::string strategy, fabric;
  int side = 77;      ///< particles along a side of the finest grid
  double time = 0.2;  ///< simulated time before the measurement [s]
  int threads = 1;
};

/// The box drape after some time: the state on which passes are measured, with all particles awake.
class ClothCase {
 public:
  explicit ClothCase(const CaseOptions& options);

  const CaseOptions& options() const { return options_; }
  const Scene& scene() const { return world_->scene(); }
  const Fabric& fabric() const { return scene().cloth.fabric; }
  const Cloth& cloth() const { return world_->cloth(); }
  const ActiveMesh& mesh() const { return cloth().mesh(); }

  /// Parts of the world that single passes run on.
  InternalEnergy& internal() { return world_->cloth_.internal(); }
  ContactSet& contacts() { return world_->contacts_; }
  ClothObjective& objective() { return world_->solver_.objective(); }

  int threads() const { return world_->threads(); }
  void setThreads(int threads) { world_->team_ = Team(threads); }

  /// Unknowns near the last state, as the solver has them, and a search direction.
  const Vector& point() const { return point_; }
  const Vector& direction() const { return direction_; }
  const Field& nodes() const { return nodes_; }    ///< the same, by node
  const Field& motion() const { return motion_; }  ///< the direction, by node
  const Motion& motionTerms() const { return terms_; }
  void lookAtMesh();  ///< decides about the mesh without changing it
  const std::vector<double>& reach() const { return reach_; }
  const Field& still() const { return still_; }
  Vector& scratch() { return scratch_; }
  Field& gradient() { return gradient_; }

  int particles() const { return mesh().active(); }
  int places() const { return mesh().nodes(); }

  struct Iterations {
    int iterations = 0, evaluations = 0;
    /// Wall time, and processor time of all threads together.
    double seconds = 0.0, cpu_seconds = 0.0;
  };

  /// Runs work() so often in one parallel region, as a step does. @return its last result
  template <class Work>
  double inRegion(int times, const Work& work) {
    double last = 0.0;
    world_->team_.run(mesh().active(), [&] {
      for (int k = 0; k < times; ++k) last = work();
    });
    return last;
  }

  /// Runs whole iterations on the cloth, starting at point().
  Iterations iterate(int iterations);

  /// Runs as many iterations on an objective that costs nothing: the minimizer's own vector
  /// updates.
  Iterations iterateVectors(int iterations);

 private:
  Iterations minimize(Objective& potential, int iterations);
  void measureUnder();

  CaseOptions options_;
  std::unique_ptr<ClothWorld> world_;
  Adaptation adaptation_;
  Minimizer minimizer_;        ///< kept, as the solver keeps its own: only the first run waits for new pages
  std::vector<double> reach_;  ///< per node, as in a step with a cloth at rest [m]
  Field still_;                ///< their expected motion in that step, none [m]
  Vector point_, direction_, scratch_, start_;
  Field nodes_, motion_, gradient_, start_nodes_, inertial_;
  std::vector<double> mass_, moving_mass_;
  Proxies proxies_;
  Motion terms_{};
};

}  // namespace haptic_cloth
