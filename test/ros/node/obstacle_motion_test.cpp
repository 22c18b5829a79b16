/// Obstacles that a topic moves.
#include "ros/node/obstacle_motion.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <functional>
#include <random>
#include <vector>

#include "haptic_cloth/simulation.h"
#include "support/scenes.h"

namespace haptic_cloth::obstacle_motion_test {
namespace {

constexpr double kStep = 1e-3;  // [s]

/// Poses along x by a sensor, at the places where something is at that time.
struct Sensor {
  double period, jitter;                ///< time between poses [s], and its largest change [-]
  std::function<double(double)> place;  ///< at a time [m]
};

/// Places of the obstacle after each step.
std::vector<double> follow(const Sensor& sensor, double end) {
  std::mt19937 random(7);
  std::uniform_real_distribution<double> late(-sensor.jitter, sensor.jitter);
  ObstacleMotion motion;
  Pose now;
  std::vector<double> places;
  double next = 0.0;
  for (double time = 0.0; time < end; time += kStep) {
    if (time >= next) {
      Pose pose;
      pose.position.x() = sensor.place(time);
      motion.aim(pose, time);
      next += sensor.period * (1.0 + late(random));
    }
    if (motion.isOnItsWay()) now = motion.advance(now, kStep);
    places.push_back(now.position.x());
  }
  return places;
}

/// An even motion stays even: 1.25 for the margin over the interval, and the jitter of the way. It is never
/// faster than 1/0.8, by which the obstacle catches up in the first 2.5 s, and the jitter.
TEST(ObstacleMotion, FollowsAnEvenMotionEvenly) {
  constexpr double kSpeed = 0.2, kJitter = 0.1;
  for (const double period : {0.1, 0.033, 0.008}) {
    const auto at = [](double time) { return kSpeed * time; };
    const std::vector<double> places = follow({period, kJitter, at}, 4.0);
    for (std::size_t k = 1; k < places.size(); ++k)
      EXPECT_LT((places[k] - places[k - 1]) / kStep, 1.35 * kSpeed) << period << " s, step " << k;
    for (std::size_t k = 3000; k < places.size(); ++k) {
      const double time = (static_cast<double>(k) + 1.0) * kStep;
      EXPECT_NEAR((places[k] - places[k - 1]) / kStep, kSpeed, 0.35 * kSpeed) << period << " s at " << time;
      // It is on the way to the newest pose, which is up to 1.1 periods old, for up to 1.25 of 1.1 periods.
      EXPECT_LT(places[k], at(time)) << period << " s at " << time;
      EXPECT_GT(places[k], at(time - 2.5 * period - kStep)) << period << " s at " << time;
    }
  }
}

TEST(ObstacleMotion, TakesHalfASecondForAPoseAlone) {
  const std::vector<double> places = follow({10.0, 0.0, [](double) { return 0.1; }}, 0.6);
  EXPECT_NEAR(places[249], 0.05, 1e-9);
  EXPECT_NEAR(places[499], 0.1, 1e-9);
  EXPECT_EQ(places[510], 0.1);
}

TEST(ObstacleMotion, Turns) {
  ObstacleMotion motion;
  Pose target;
  target.orientation = Eigen::AngleAxisd(0.8, Vec3::UnitY());
  motion.aim(target, 0.0);
  const Pose half = motion.advance(Pose(), 0.25);
  EXPECT_NEAR(half.orientation.angularDistance(Quat::Identity()), 0.4, 1e-9);
  EXPECT_NEAR(half.orientation.angularDistance(target.orientation), 0.4, 1e-9);
}

/// While it catches up, a fast turn lags by more than half a turn, and goes on in its direction.
TEST(ObstacleMotion, TurnsOnwardsByWholeTurns) {
  constexpr double kSpin = 25.0, kPeriod = 0.01;  // rad/s, s
  const Vec3 axis = Vec3(1.0, 2.0, -0.5).normalized();
  ObstacleMotion motion;
  Pose now;
  double next = 0.0, turned = 0.0;
  for (double time = 0.0; time < 4.0; time += kStep) {
    if (time >= next) {
      Pose pose;
      pose.orientation = Eigen::AngleAxisd(kSpin * time, axis);
      motion.aim(pose, time);
      next += kPeriod;
    }
    const Quat before = now.orientation;
    if (motion.isOnItsWay()) now = motion.advance(now, kStep);
    const Eigen::AngleAxisd turn(now.orientation * before.conjugate());
    const double part = turn.angle() * turn.axis().dot(axis);
    EXPECT_GE(part, -1e-9) << time;
    EXPECT_LE(part, 1.3 * kSpin * kStep) << time;  // as FollowsAnEvenMotionEvenly, with little jitter
    turned += part;
  }
  EXPECT_NEAR(turned, kSpin * 4.0, 3.0 * kPeriod * kSpin);
}

/// A sensor sends the pose of something that stands still, again and again.
TEST(ObstacleMotion, StandsStillToTheBit) {
  LinearFabric linear;
  Scene scene = sheetScene(makeFabric(linear), 5, 5, 0.1, 0.1);
  Obstacle block;
  block.shape = Shape::Box;
  block.size = Vec3(0.1, 0.1, 0.1);
  scene.obstacles.push_back(block);
  Simulation simulation(scene);
  Pose pose;
  pose.position = Vec3(0.3, 0.1, -0.2);
  pose.orientation = Eigen::AngleAxisd(0.7, Vec3(1.0, -2.0, 0.4).normalized());
  ObstacleMotion motion;
  std::vector<Pose> poses;
  for (int k = 0; k < 4000; ++k) {
    if (k % 10 == 0) motion.aim(pose, simulation.time());
    if (motion.isOnItsWay()) simulation.moveObstacle(0, motion.advance(simulation.obstaclePose(0), kStep));
    simulation.step();
    poses.push_back(simulation.obstaclePose(0));
  }
  for (std::size_t k = 3500; k < poses.size(); ++k) {
    EXPECT_EQ(poses[k].position, poses[k - 1].position) << k;
    EXPECT_EQ(poses[k].orientation.coeffs(), poses[k - 1].orientation.coeffs()) << k;
  }
}

/// Cloth lies on a block that poses raise at 0.1 m/s. Raised evenly the block throws the cloth by v²/2g = 0.5
/// mm where it stops, at a third more speed by 0.9 mm; raised by the way of a pose in a step, the cloth flew
/// up by decimetres.
TEST(ObstacleMotion, RaisesClothWithoutThrowingIt) {
  for (const double period : {0.1, 0.033, 0.01, 0.002}) {
    LinearFabric linear;
    linear.rigidity = 1e-5;
    linear.compression = 0.1;
    Scene scene = sheetScene(makeFabric(linear), 17, 17, 0.2, 0.2);
    Obstacle block;
    block.shape = Shape::Box;
    block.size = Vec3(0.15, 0.15, 0.1);
    scene.obstacles.push_back(block);
    scene.cloth.pose.position.z() = 0.0505;
    Simulation simulation(scene);
    const auto highest = [&] {
      std::vector<Vec3> positions;
      simulation.positions(positions);
      double most = -1.0;
      for (const Vec3& x : positions) most = std::max(most, x.z());
      return most - simulation.obstaclePose(0).position.z() - 0.05;
    };
    for (int k = 0; k < 300; ++k) simulation.step();
    const double before = highest();
    ObstacleMotion motion;
    double next = 0.0, most = 0.0;
    for (double time = 0.0; time < 1.5; time += kStep) {
      if (time >= next) {
        Pose pose = block.pose;
        pose.position.z() += 0.1 * std::min(time, 1.0);
        motion.aim(pose, simulation.time());
        next += period;
      }
      if (motion.isOnItsWay()) simulation.moveObstacle(0, motion.advance(simulation.obstaclePose(0), kStep));
      simulation.step();
      most = std::max(most, highest() - before);
    }
    EXPECT_GT(simulation.obstaclePose(0).position.z(), 0.08) << "it rises";
    EXPECT_LT(most, 1e-3) << period << " s";
  }
}

}  // namespace
}  // namespace haptic_cloth::obstacle_motion_test
