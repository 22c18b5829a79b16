/// Simulation::setOptions(). Criterion: docs/reference/scenes.md, column "live" and rules.
#include <gtest/gtest.h>

#include <functional>
#include <limits>
#include <string>

#include "haptic_cloth/error.h"
#include "haptic_cloth/scene.h"
#include "haptic_cloth/simulation.h"
#include "scene/scene_options.h"

namespace haptic_cloth::set_options_test {
namespace {

class SetOptions : public ::testing::Test {
 protected:
  void set(const StepOptions& options) {
    simulation_.setOptions(options.solver, options.adapt, options.air_damping);
  }

  /// Expects a refusal of this change, with a message that says so, and nothing changed.
  void refuse(const std::function<void(StepOptions&)>& change, const std::string& message) {
    StepOptions options = now();
    change(options);
    try {
      set(options);
      ADD_FAILURE() << "not refused: " << message;
    } catch (const InputError& error) {
      EXPECT_NE(std::string(error.what()).find(message), std::string::npos) << error.what();
    }
    StepOptions left = now(), first = first_;
    const Options rows = optionsOf(left), before = optionsOf(first);
    for (std::size_t k = 0; k < rows.size(); ++k)
      EXPECT_EQ(valueText(rows[k]), valueText(before[k])) << rows[k].key;
  }

  StepOptions now() const { return stepOptions(simulation_.scene()); }

  Simulation simulation_{parseScene("cloth: {fabric: linear, particles: [9, 9]}\n", "scene", ".")};
  const StepOptions first_ = now();
};

TEST_F(SetOptions, TakesLiveOnes) {
  StepOptions options = now();
  options.solver.minimizer.tolerance = 0.25;
  options.adapt.refine_above = 0.9;
  options.air_damping = 1.5;
  set(options);
  EXPECT_EQ(now().solver.minimizer.tolerance, 0.25);
  EXPECT_EQ(now().adapt.refine_above, 0.9);
  EXPECT_EQ(now().air_damping, 1.5);
}

TEST_F(SetOptions, RefusesThoseThatAreFixed) {
  const std::string rule = ": cannot change while the simulation runs";
  refuse([](StepOptions& o) { o.solver.time_step *= 2.0; }, "solver.time_step" + rule);
  refuse([](StepOptions& o) { o.solver.cost = Cost::Joint; }, "solver.cost" + rule);
  refuse([](StepOptions& o) { o.solver.threads = 2; }, "solver.threads" + rule);
  refuse([](StepOptions& o) { o.adapt.levels -= 1; }, "adapt.levels" + rule);
  refuse([](StepOptions& o) { o.adapt.strategy = Strategy::Finest; }, "adapt.strategy" + rule);
  refuse([](StepOptions& o) { o.adapt.start = StartMesh::Coarsest; }, "adapt.start" + rule);
}

TEST_F(SetOptions, ChecksValuesAndHowTheyFit) {
  constexpr double kNan = std::numeric_limits<double>::quiet_NaN();
  refuse([](StepOptions& o) { o.air_damping = kNan; }, "air_damping = nan: must be >= 0");
  refuse([](StepOptions& o) { o.air_damping = -1.0; }, "air_damping = -1: must be >= 0");
  refuse([](StepOptions& o) { o.solver.minimizer.max_iterations = 0; }, "solver.max_iterations = 0: must be");
  refuse([](StepOptions& o) { o.adapt.coarsen_below = o.adapt.refine_above; },
         "adapt.coarsen_below = 0.7: must be below adapt.refine_above = 0.7");
}

}  // namespace
}  // namespace haptic_cloth::set_options_test
