/// Scenes drawn over the whole space of options, as text that `simulate` takes too.
#pragma once

#include <cstdint>
#include <string>

namespace haptic_cloth {

/// How much one scene may cost.
struct RandomSceneLimits {
  int particles = 6000;  ///< of the finest grid
  double work = 6e4;     ///< particles times steps; a tenth of it under solver.cost: joint
};

/// A valid scene, YAML, the same for the same seed on every machine. Sizes, levels, fabrics, pins, obstacles
/// of every shape (also around, inside and far from the cloth), probes that go through it, grasps, both
/// costs, every strategy and criterion, steps of 0.1 to 20 ms, budgets of 1 to 200 iterations.
std::string randomScene(std::uint64_t seed, const RandomSceneLimits& limits);

}  // namespace haptic_cloth
