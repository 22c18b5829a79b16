/// Properties of shapes that search and display use. Criterion: its signed distance; the bound is rounding.
#include "shape/shapes.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <vector>

#include "contact/solid.h"
#include "support/tolerance.h"

namespace haptic_cloth::shapes_test {
namespace {

const double kRounding = tolerance(8 * std::numeric_limits<double>::epsilon());

/// Points of the surface of a part, its farthest among them.
std::vector<Vec3> surfacePoints(const DrawnPart& part) {
  std::vector<Vec3> points;
  const auto add = [&](double x, double y, double z) {
    points.push_back(part.offset + 0.5 * part.size.cwiseProduct(Vec3(x, y, z)));
  };
  for (const double side : {-1.0, 1.0}) {
    for (int k = 0; k < 8; ++k) {
      const double x = std::cos(k * M_PI / 4.0), y = std::sin(k * M_PI / 4.0);
      if (part.body == DrawnPart::kCylinder) add(x, y, side);
      if (part.body == DrawnPart::kSphere) add(x, y, 0.0);
    }
    if (part.body == DrawnPart::kSphere) add(0.0, 0.0, side);
    for (const double y : {-1.0, 1.0}) {
      for (const double z : {-1.0, 1.0}) {
        if (part.body == DrawnPart::kCube) add(side, y, z);
      }
    }
  }
  return points;
}

std::vector<Vec3> surfacePoints(const Obstacle& obstacle) {
  std::vector<Vec3> points;
  for (const DrawnPart& part : drawing(obstacle)) {
    for (const Vec3& point : surfacePoints(part)) points.push_back(point);
  }
  return points;
}

/// Smallest and largest distance of points from a solid.
std::array<double, 2> distances(const Solid& solid, const std::vector<Vec3>& points, double factor) {
  std::array<double, 2> ends{1e300, -1e300};
  for (const Vec3& point : points) {
    const double value = solid.distance(factor * point).value;
    ends = {std::min(ends[0], value), std::max(ends[1], value)};
  }
  return ends;
}

TEST(Shapes, DrawingExtentAndHalfWidthAreThoseOfTheDistance) {
  constexpr double kCoarse = 0.05;  // a drawing may lie this far inside, as a share of the extent
  for (const auto& [name, shape] : shapeNames()) {
    Obstacle obstacle;
    obstacle.shape = shape;
    obstacle.size = Vec3(0.5, 0.25, 0.125);
    obstacle.radius = 0.25;
    obstacle.length = 0.3;
    const Solid solid(obstacle);
    const std::vector<Vec3> drawn = surfacePoints(obstacle);
    const double coarse = kCoarse * solid.extent(), highest = distances(solid, drawn, 1.0)[1];
    EXPECT_LE(highest, kRounding) << name << ": what is drawn lies in the solid";
    EXPECT_GE(highest, -coarse - kRounding) << name << ": and reaches its surface";
    if (!std::isfinite(solid.halfWidth())) continue;

    std::vector<Vec3> directions;
    for (const Vec3& point : drawn) directions.push_back(point.normalized());
    const double out = distances(solid, directions, solid.extent())[0];
    EXPECT_GE(out, -kRounding) << name << ": the solid ends at its extent";
    EXPECT_LE(out, coarse + kRounding) << name << ": and reaches it";

    // The widest ball in a solid is no wider than the solid; in a symmetric one it is as wide.
    const double depth = -solid.distance(Vec3::Zero()).value;
    EXPECT_LE(depth, solid.halfWidth() + kRounding) << name;
    const std::array<double, 2> mirrored = distances(solid, drawn, -1.0);
    if (mirrored[1] < kRounding) {
      EXPECT_NEAR(depth, solid.halfWidth(), kRounding) << name;
    }
  }
}

/// Criterion: faces stay where they are; over an edge the surface is an arc around a line within the solid,
/// over a corner a part of a ball. A radius beyond half of the smallest width is cut to that.
TEST(Shapes, EdgesAreRoundedWithinTheSolid) {
  Obstacle box;
  box.shape = Shape::Box;
  box.size = Vec3(0.2, 0.4, 0.6);
  const double r = 0.02;
  const Solid rounded(box, r);
  EXPECT_NEAR(rounded.distance(Vec3(0.13, 0.0, 0.0)).value, 0.03, kRounding) << "over a face";
  EXPECT_NEAR(rounded.distance(Vec3(0.1, 0.2, 0.0)).value, (std::sqrt(2.0) - 1.0) * r, kRounding) << "edge";
  EXPECT_NEAR(rounded.distance(Vec3(0.1, 0.2, 0.3)).value, (std::sqrt(3.0) - 1.0) * r, kRounding) << "corner";
  EXPECT_NEAR(rounded.distance(Vec3(0.0, 0.0, 0.0)).value, -0.1, kRounding) << "centre";
  EXPECT_NEAR(Solid(box, 1.0).distance(Vec3(0.1, 0.2, 0.0)).value, (std::sqrt(2.0) - 1.0) * 0.1, kRounding);
  Obstacle cylinder;
  cylinder.shape = Shape::Cylinder;
  cylinder.radius = 0.1;
  cylinder.length = 0.6;
  const Solid rim(cylinder, r);
  EXPECT_NEAR(rim.distance(Vec3(0.0, 0.12, 0.1)).value, 0.02, kRounding) << "beside the round face";
  EXPECT_NEAR(rim.distance(Vec3(0.0, 0.1, 0.3)).value, (std::sqrt(2.0) - 1.0) * r, kRounding) << "rim";
}

/// Reference: places and lengths that can be read off the drawing of each solid.
TEST(Shapes, KnowTheNearestSharpEdge) {
  Obstacle box;
  box.shape = Shape::Box;
  box.size = Vec3(0.2, 0.4, 0.6);
  box.pose.position = Vec3(1.0, 0.0, 0.0);
  EXPECT_NEAR(Solid(box).edgeDistance(Vec3(1.1, 0.2, 0.1)), 0.0, kRounding) << "on an edge";
  EXPECT_NEAR(Solid(box).edgeDistance(Vec3(1.05, 0.2, 0.0)), 0.05, kRounding) << "on a face";
  EXPECT_NEAR(Solid(box).edgeDistance(Vec3(1.0 - 0.13, -0.24, 0.0)), 0.05, kRounding) << "beside an edge";
  EXPECT_NEAR(Solid(box).edgeDistance(Vec3(1.1, 0.2, 0.4)), 0.1, kRounding) << "beyond its end";
  EXPECT_NEAR(Solid(box).edgeDistance(Vec3(1.0, 0.0, 0.0)), std::hypot(0.1, 0.2), kRounding) << "centre";
  box.pose.orientation = Quat(Eigen::AngleAxisd(0.5 * EIGEN_PI, Vec3::UnitZ()));
  EXPECT_NEAR(Solid(box).edgeDistance(Vec3(1.2, 0.05, 0.0)), 0.05, kRounding) << "turned";
  Obstacle cylinder;
  cylinder.shape = Shape::Cylinder;
  cylinder.radius = 0.1;
  cylinder.length = 0.6;
  EXPECT_NEAR(Solid(cylinder).edgeDistance(Vec3(0.0, 0.13, -0.34)), 0.05, kRounding) << "beside a rim";
  EXPECT_NEAR(Solid(cylinder).edgeDistance(Vec3(0.0, 0.0, 0.3)), 0.1, kRounding) << "on the axis";
  for (const Shape shape : {Shape::Sphere, Shape::Capsule, Shape::Plane}) {
    cylinder.shape = shape;
    EXPECT_TRUE(std::isinf(Solid(cylinder).edgeDistance(Vec3(0.1, 0.0, 0.3))));
  }
}

TEST(Shapes, AProbeIsASphereOrACapsule) {
  ProbeOptions probe;
  probe.friction = 0.7;
  EXPECT_EQ(solidOf(probe).shape, Shape::Sphere);
  EXPECT_EQ(solidOf(probe).friction, 0.7);
  probe.length = 0.03;
  EXPECT_EQ(solidOf(probe).shape, Shape::Capsule);
  EXPECT_EQ(solidOf(probe).length, 0.03);
}

}  // namespace
}  // namespace haptic_cloth::shapes_test
