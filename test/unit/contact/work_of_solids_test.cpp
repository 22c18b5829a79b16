/// Work of moving obstacles on the cloth that they press.
/// Criteria: a wall that turns does no work on cloth that turns along with it, because its pressure is normal
/// to the way, and any work in straight motion is force times way. Both up to rounding, 1e-16 in each
/// position, over the smallest length that counts, the gap of 1e-4 m.
#include <gtest/gtest.h>

#include <cmath>

#include "contact/contact_set.h"
#include "support/tolerance.h"

namespace haptic_cloth::work_of_solids_test {
namespace {

constexpr double kRange = 5e-4;  // gap at which contact begins [m]
constexpr double kGap = 0.2 * kRange, kDistance = 0.1, kRounding = 1e-11;

struct Pressed {
  double work;   ///< of the wall [J]
  double force;  ///< on the cloth [N]
  double way;    ///< of the cloth [m]
};

/// A frictionless wall below the middle of a flat sheet moves, and the sheet moves along.
Pressed carryAlong(const Pose& wall_before, const Pose& wall_after) {
  const Grid grid{5, 5, 0, 4e-3, 4e-3};
  const LeafMesh leaves(grid, {}, 0);
  const ActiveMesh mesh(leaves, 0.15);
  Obstacle wall;
  wall.shape = Shape::Plane;
  wall.friction = 0.0;
  wall.pose = wall_before;
  Field before, after, motion;
  for (Field* field : {&before, &after, &motion}) field->clear(mesh.nodes());
  for (int n = 0; n < mesh.nodes(); ++n) {
    const int p = mesh.particle[n];
    const Vec3 place(grid.dx * (grid.column(p) - 2), grid.dy * (grid.row(p) - 2), kGap);
    before.set(n, wall_before.position + wall_before.orientation * place);
    after.set(n, wall_after.position + wall_after.orientation * place);
    motion.set(n, after[n] - before[n]);
  }
  Team team(1);
  ContactSet contacts(grid, {wall}, {}, {kRange, 1e-3, 1e-3}, team);
  contacts.moveObstacle(0, wall_after);
  contacts.advance(1e-3, before);
  contacts.collectProbes(mesh, before, std::vector<double>(mesh.nodes(), 1e-2), motion, {});
  contacts.collectObstacles(mesh, before, std::vector<double>(mesh.nodes(), 1e-2), motion);
  contacts.evaluate(0, contacts.size(), after);
  return {contacts.workOfSolids(), contacts.obstacleForce().norm(), (after[0] - before[0]).norm()};
}

TEST(WorkOfSolids, IsNoneOnClothThatTurnsAlong) {
  for (const double turn : {1e-3, 1e-2, 0.05}) {
    for (const double side : {-1.0, 1.0}) {  // within the walls and outside them
      const Quat start(Eigen::AngleAxisd(0.3, Vec3::UnitY())),
          end(Eigen::AngleAxisd(0.3 + turn, Vec3::UnitY()));
      const auto pose = [&](const Quat& turned) {
        return Pose{turned * Vec3(0.0, 0.0, side * kDistance), turned};
      };
      const Pressed pressed = carryAlong(pose(start), pose(end));
      ASSERT_GT(pressed.force, 0.01);
      EXPECT_NEAR(pressed.work, 0.0, tolerance(kRounding * pressed.force * pressed.way)) << turn;
    }
  }
}

TEST(WorkOfSolids, IsForceTimesWayInStraightMotion) {
  const Vec3 way(1e-3, 0.0, 2e-3);
  const Quat tilted(Eigen::AngleAxisd(0.3, Vec3::UnitY()));
  const Pressed pressed = carryAlong({Vec3::Zero(), tilted}, {way, tilted});
  ASSERT_GT(pressed.force, 0.01);
  const double expected = pressed.force * way.dot(tilted * Vec3::UnitZ());
  EXPECT_NEAR(pressed.work, expected, tolerance(kRounding * pressed.force * pressed.way));
}

}  // namespace
}  // namespace haptic_cloth::work_of_solids_test
