/// Law of smoothed friction.
/// Criterion: by definition. Its derivatives are central differences over 1e-4 of the slip, whose error is of
/// second order: 1e-8 times a factor below 100.
#include "contact/friction_law.h"

#include <gtest/gtest.h>

#include <cmath>

namespace haptic_cloth::friction_law_test {
namespace {

constexpr double kSlip = 3e-7;  // [m]
constexpr double kNudge = 1e-4, kDifference = 1e-6;
// On both sides of the end of the smoothed part, and not so near that a difference spans it.
constexpr double kSlips[] = {0.01, 0.3, 0.999, 1.001, 2.0, 100.0};  // [kSlip]

TEST(FrictionLaw, ForceAndItsChangeAreDerivativesOfThePotential) {
  for (const double share : kSlips) {
    const double y = share * kSlip, step = kNudge * y;
    const SmoothSlip at = smoothSlip(y, kSlip), ahead = smoothSlip(y + step, kSlip),
                     behind = smoothSlip(y - step, kSlip);
    const double force = (ahead.potential - behind.potential) / (2.0 * step),
                 change = (ahead.ratio - behind.ratio) / (2.0 * step) / y;
    EXPECT_NEAR(at.ratio * y, force, kDifference * force) << share;
    EXPECT_NEAR(at.slope, change, kDifference * std::abs(change)) << share;
  }
}

TEST(FrictionLaw, BlockIsTheChangeOfTheForce) {
  constexpr double kLimit = 1e-3;  // [N]
  const Vec3 normal = Vec3(0.3, -0.2, 0.9).normalized(), along = normal.cross(Vec3::UnitX()).normalized();
  const auto force = [&](const Vec3& place) -> Vec3 {
    const Vec3 slip = place - normal.dot(place) * normal;
    return kLimit * smoothSlip(slip.norm(), kSlip).ratio * slip;
  };
  for (const double share : kSlips) {
    const Vec3 slip = share * kSlip * along;
    const Block block = frictionBlock(slip, normal, kLimit, kSlip);
    const double largest = kLimit * smoothSlip(slip.norm(), kSlip).ratio;  // across the slip [N/m]
    for (int c = 0; c < 3; ++c) {
      const Vec3 step = kNudge * slip.norm() * Vec3::Unit(c);
      const Vec3 change = (force(slip + step) - force(slip - step)) / (2.0 * kNudge * slip.norm());
      EXPECT_LT((product(block, Vec3::Unit(c)) - change).norm(), kDifference * largest) << share << " " << c;
    }
  }
}

}  // namespace
}  // namespace haptic_cloth::friction_law_test
