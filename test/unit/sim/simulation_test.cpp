/// Calls of the public class Simulation. Criterion: include/haptic_cloth/simulation.h.
#include "haptic_cloth/simulation.h"

#include <gtest/gtest.h>

#include <cmath>
#include <functional>
#include <limits>
#include <string>
#include <vector>

#include "haptic_cloth/error.h"
#include "haptic_cloth/scene.h"

namespace haptic_cloth::simulation_test {
namespace {

TEST(SimulationCalls, RefuseProbesAndObstaclesThatAreNotThere) {
  Simulation simulation(
      parseScene("cloth: {fabric: linear, particles: [9, 9]}\nobstacles: [{shape: plane}]\n", "scene", "."));
  simulation.step();
  const std::string before = simulation.saveState();
  std::vector<std::string> recorded;
  simulation.record([&](const std::string& line) { recorded.push_back(line); });
  const std::size_t header = recorded.size();
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
  EXPECT_EQ(recorded.size(), header);
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

/// Numbers that overflow in the step would fail it, and stay in the balance of energy.
TEST(SimulationCalls, IgnoreWhatIsBeyondTheirLimits) {
  Simulation simulation(
      parseScene("cloth: {fabric: linear, particles: [9, 9]}\nobstacles: [{shape: plane}]\n", "scene", "."));
  const Vec3 place(0.0, 0.0, 0.1), still = Vec3::Zero();
  simulation.setDevice(place, still);
  simulation.step();
  const std::string before = simulation.saveState();
  std::vector<std::string> recorded;
  simulation.record([&](const std::string& line) { recorded.push_back(line); });
  const std::size_t header = recorded.size();
  const Quat turn = Quat::Identity(), huge(1e200, 0.0, 0.0, 0.0);
  for (const double far :
       {5e7, 1e200, std::numeric_limits<double>::infinity(), std::numeric_limits<double>::quiet_NaN()}) {
    simulation.setDevice(0, {place, Vec3(far, 0.0, 0.0), turn});
    simulation.setDevice(0, {Vec3(far, 0.0, 0.1), still, turn});
    if (!std::isfinite(far)) simulation.setDevice(0, {place, still, turn, far});
    simulation.moveObstacle(0, {Vec3(0.0, 0.0, far), turn});
  }
  simulation.setDevice(0, {place, still, huge});
  simulation.moveObstacle(0, {still, huge});
  EXPECT_EQ(recorded.size(), header) << recorded.back();
  EXPECT_TRUE(simulation.saveState() == before);
  simulation.record(nullptr);
  EXPECT_FALSE(simulation.step().failed);
  EXPECT_TRUE(std::isfinite(simulation.energy().dissipated));
}

TEST(SimulationCalls, ASinkThatThrowsEndsItsRecording) {
  Simulation simulation(parseScene("cloth: {fabric: linear, particles: [9, 9]}\n", "scene", "."));
  EXPECT_THROW(simulation.record([](const std::string&) { throw std::runtime_error("full"); }),
               std::runtime_error);
  EXPECT_FALSE(simulation.step().failed);
  bool full = false;
  simulation.record([&](const std::string&) {
    if (full) throw std::runtime_error("full");
  });
  full = true;
  EXPECT_THROW(simulation.record(nullptr), std::runtime_error) << "the last line";
  EXPECT_NO_THROW(simulation.record(nullptr));
  EXPECT_FALSE(simulation.step().failed);
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
}  // namespace haptic_cloth::simulation_test
