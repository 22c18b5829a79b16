/// Calls of the public class Simulation. Criterion: include/haptic_cloth/simulation.h.
#include "haptic_cloth/simulation.h"

#include <gtest/gtest.h>

#include <functional>
#include <string>
#include <vector>

#include "haptic_cloth/error.h"
#include "haptic_cloth/scene.h"

namespace haptic_cloth {
namespace {

TEST(SimulationCalls, RefuseProbesAndObstaclesThatAreNotThere) {
  Simulation simulation(
      parseScene("cloth: {fabric: linear, particles: [9, 9]}\nobstacles: [{shape: plane}]\n", "scene", "."));
  simulation.step();
  const std::string before = simulation.saveState();
  std::vector<std::string> recorded;
  simulation.record([&](const std::string& line) { recorded.push_back(line); });
  for (const int number : {-1, 1, 1000000}) {
    const std::vector<std::function<void()>> calls = {
        [&] { simulation.setDevice(number, {}); },  [&] { simulation.removeDevice(number); },
        [&] { simulation.setGrasp(number, true); }, [&] { simulation.setCoupling(number, 100.0, 1.0); },
        [&] { simulation.probe(number); },          [&] { simulation.moveObstacle(number, {}); },
        [&] { simulation.obstaclePose(number); },
    };
    for (const auto& call : calls) {
      try {
        call();
        ADD_FAILURE() << number << " was taken";
      } catch (const InputError& error) {
        EXPECT_NE(std::string(error.what()).find(" = " + std::to_string(number) + ": must be one of"),
                  std::string::npos)
            << error.what();
      }
    }
  }
  EXPECT_EQ(simulation.saveState(), before);
  EXPECT_TRUE(recorded.empty());
}

/// A plane that keeps its place turns as asked, at once, since it has no width that limits its way.
TEST(SimulationCalls, TurnAPlane) {
  Simulation simulation(
      parseScene("cloth: {fabric: linear, particles: [9, 9]}\nobstacles: [{shape: plane}]\n", "scene", "."));
  const Quat turned(Eigen::AngleAxisd(0.3, Vec3::UnitX()));
  simulation.moveObstacle(0, {simulation.obstaclePose(0).position, turned});
  simulation.step();
  EXPECT_LT(simulation.obstaclePose(0).orientation.angularDistance(turned), 1e-12);  // rounding
}

/// The joint cost divides by the mass of the free nodes, and a probe's if there is one.
TEST(SimulationCalls, ClothWithoutFreeNodesStaysWithEitherCost) {
  for (const std::string cost : {"condensed", "joint"}) {
    Simulation simulation(
        parseScene("cloth: {fabric: linear, particles: [9, 9], pins: [{particles: [[0, 8], [0, 8]]}]}\n"
                   "solver: {cost: " +
                       cost + "}\n",
                   "scene", "."));
    for (int k = 0; k < 3; ++k) {
      const StepReport report = simulation.step();
      EXPECT_FALSE(report.failed) << cost;
      EXPECT_EQ(report.minimizer.residual, 0.0) << cost;
    }
  }
}

}  // namespace
}  // namespace haptic_cloth
