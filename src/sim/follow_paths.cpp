#include <algorithm>

#include "haptic_cloth/simulation.h"

namespace haptic_cloth {

void followPaths(Simulation& simulation, int length) {
  length = std::max(1, length);
  const Scene& scene = simulation.scene();
  const double step = length * scene.solver.time_step, end = simulation.time() + step;
  for (std::size_t k = 0; k < scene.probes.size(); ++k) {
    const ProbeOptions& probe = scene.probes[k];
    if (probe.path.empty()) continue;
    const Vec3 from = pathPosition(probe.path, simulation.time()), to = pathPosition(probe.path, end);
    simulation.setDevice(static_cast<int>(k), {to, (to - from) / step, probe.orientation, step});
    const bool closed = std::any_of(probe.grasp.begin(), probe.grasp.end(),
                                    [&](const auto& times) { return times[0] <= end && end < times[1]; });
    simulation.setGrasp(static_cast<int>(k), closed);
  }
  for (std::size_t k = 0; k < scene.obstacles.size(); ++k) {
    const Obstacle& obstacle = scene.obstacles[k];
    if (obstacle.path.empty()) continue;
    simulation.moveObstacle(static_cast<int>(k),
                            {pathPosition(obstacle.path, end), obstacle.pose.orientation});
  }
}

}  // namespace haptic_cloth
