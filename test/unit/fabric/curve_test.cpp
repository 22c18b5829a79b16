/// Tabulated law: its integral, its ends and its zero.
#include "haptic_cloth/curve.h"

#include <gtest/gtest.h>

#include <cmath>
#include <vector>

#include "haptic_cloth/error.h"
#include "haptic_cloth/loop.h"

namespace haptic_cloth::curve_test {
namespace {

const Curve kBent(-0.5, 0.25, {-3.0, -1.0, 0.0, 2.0, 7.0});

TEST(Curve, PassesThroughItsSamplesAndIsLinearBetween) {
  EXPECT_DOUBLE_EQ(kBent(-0.5).force, -3.0);
  EXPECT_DOUBLE_EQ(kBent(0.25).force, 2.0);
  EXPECT_DOUBLE_EQ(kBent(0.375).force, 4.5);
  EXPECT_DOUBLE_EQ(kBent(0.375).slope, 20.0);
}

TEST(Curve, RefusesWhatIsNoCurve) {
  EXPECT_THROW(Curve(0.0, 1.0, {5.0}), InputError);
  EXPECT_THROW(Curve(0.0, 0.0, {0.0, 1.0}), InputError);
  for (const double odd : {std::nan(""), std::numeric_limits<double>::infinity()}) {
    EXPECT_THROW(Curve::linear(odd), InputError);
    EXPECT_THROW(Curve(odd, 1.0, {0.0, 1.0}), InputError);
    EXPECT_THROW(Curve(0.0, odd, {0.0, 1.0}), InputError);
    EXPECT_THROW(Loop(0.0, 1.0, {0.0, odd}, {0.0, 1.0}, 2.0), InputError);
  }
  EXPECT_THROW(Loop(0.0, 1.0, {0.0, 1.0}, {0.0}, 2.0), InputError);
  EXPECT_THROW(Loop(0.0, 1.0, {0.0, 1.0}, {0.0, 1.0}, 1.0), InputError);
  EXPECT_THROW(Loop(0.0, 1.0, {0.0, 1.0}, {0.0, 1.0}, 2.0, 0.0), InputError);
}

TEST(Curve, PotentialAndForceVanishAtZero) {
  EXPECT_EQ(kBent(0.0).potential, 0.0);
  EXPECT_EQ(kBent(0.0).force, 0.0);
}

TEST(Curve, NodeAtZeroIsExactForAStepThatRounds) {
  const double step = 0.0603 / 512.0;
  const Curve curve(-512.0 * step, step, std::vector<double>(1025, 0.0));
  EXPECT_TRUE(curve.isZero());
  std::vector<double> odd;
  for (int i = -512; i <= 512; ++i) odd.push_back(i * 0.1 + i * std::abs(i) * 0.3);
  EXPECT_EQ(Curve(-512.0 * step, step, odd)(0.0).force, 0.0);
}

TEST(Curve, ContinuesLinearlyPastBothEnds) {
  EXPECT_DOUBLE_EQ(kBent(1.0).force, 7.0 + 0.5 * 20.0);
  EXPECT_DOUBLE_EQ(kBent(1.0).slope, 20.0);
  EXPECT_DOUBLE_EQ(kBent(-1.0).force, -3.0 - 0.5 * 8.0);
  EXPECT_DOUBLE_EQ(kBent(-1.0).slope, 8.0);
}

TEST(Curve, ForceIsTheDerivativeOfThePotential) {
  // The potential is quadratic within an interval, so central differences are exact there except
  // for rounding (1e-16 of values around 1 over 2e-6). At a corner they average two slopes, an
  // error of at most 2e-6 · 20.
  const double h = 1e-6;
  for (double s = -1.0; s < 1.0; s += 0.0137) {
    const double difference = (kBent(s + h).potential - kBent(s - h).potential) / (2.0 * h);
    EXPECT_NEAR(difference, kBent(s).force, 1e-7) << "s = " << s;
  }
}

TEST(Curve, PotentialIsTheAreaUnderTheForce) {
  // Triangle 0 … 0.25 with height 2, trapezium 0.25 … 0.5 from 2 to 7.
  EXPECT_DOUBLE_EQ(kBent(0.5).potential, 0.25 + 1.125);
  // Triangle -0.25 … 0 with height 1, trapezium to -0.5.
  EXPECT_DOUBLE_EQ(kBent(-0.5).potential, 0.125 + 0.5);
}

TEST(Curve, PotentialIsZeroAtZeroEvenOutsideTheTable) {
  const Curve curve(1.0, 1.0, {2.0, 4.0});
  EXPECT_DOUBLE_EQ(curve(0.0).potential, 0.0);
  EXPECT_DOUBLE_EQ(curve(3.0).potential, 9.0);
}

TEST(Curve, LinearAndZero) {
  EXPECT_DOUBLE_EQ(Curve::linear(5.0)(-2.0).force, -10.0);
  EXPECT_DOUBLE_EQ(Curve::linear(5.0)(-2.0).potential, 10.0);
  EXPECT_TRUE(Curve().isZero());
  EXPECT_TRUE(Curve::linear(0.0).isZero());
  EXPECT_FALSE(Curve::linear(1e-300).isZero());
}

}  // namespace
}  // namespace haptic_cloth::curve_test
