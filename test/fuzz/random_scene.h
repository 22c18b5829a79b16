/// Random scenes over the whole space of options, as text that `simulate` accepts too.
#pragma once

#include <cstdint>
#include <string>

namespace haptic_cloth {

/// Largest cost of one scene.
struct RandomSceneLimits {
  int particles = 6000;  ///< largest number in the finest grid
  double work = 6e4;     ///< particles times steps; a tenth of it with solver.cost: joint
};

/// A valid scene as YAML, equal for the same seed on every machine. It varies sizes, levels,
/// fabrics, pins, obstacles of every shape (also around, inside and far from the cloth), probes
/// that move through the cloth, grasps, both costs, every strategy and criterion, time steps of 0.1
/// to 20 ms and limits of 1 to 200 iterations.
std::string randomScene(std::uint64_t seed, const RandomSceneLimits& limits);

}  // namespace haptic_cloth
