/// Pressure between two layers of cloth.
/// Criteria: force and stiffness are derivatives, by central differences, whose error is δ²/6 of
/// the third derivative; the values by which KES-FB3 is defined: P_m at Tm, work WC = LC P_m (T0 -
/// Tm)/2; a continuous slope; no bound towards a distance of zero; beyond Tm
/// the integrals of a straight line and of the barrier.
#include "contact/compression_law.h"

#include <gtest/gtest.h>

#include "support/tolerance.h"

namespace haptic_cloth::compression_law_test {
namespace {

constexpr double kFree = 0.9e-3, kPressed = 0.65e-3;  // T0, Tm of a suiting [m]

CompressionLaw measured(double linearity) {
  Fabric fabric;
  fabric.thickness = 0.8e-3;
  fabric.compression = Compression{kFree, kPressed, linearity};
  return CompressionLaw(fabric);
}

CompressionLaw unmeasured() {
  Fabric fabric;
  fabric.thickness = kFree;
  return CompressionLaw(fabric);
}

TEST(CompressionLaw, ForceAndStiffnessAreDerivatives) {
  constexpr double kNudge = 1e-9;  // [m]; up to 1e-4 of the smallest distance
  for (const CompressionLaw& law : {measured(0.25), measured(0.33), measured(0.95), unmeasured()}) {
    for (double distance = 1e-5; distance < 1.1 * kFree; distance += 7.3e-6) {
      const CompressionLaw::Point here = law(distance), nearer = law(distance - kNudge),
                                  farther = law(distance + kNudge);
      const double force = (nearer.energy - farther.energy) / (2.0 * kNudge),
                   stiffness = (nearer.pressure - farther.pressure) / (2.0 * kNudge);
      EXPECT_NEAR(force, here.pressure, tolerance(1e-6) * here.pressure + tolerance(1e-6)) << distance;
      // The third derivative jumps at T0 and Tm: 1e-4 for a difference that lies across one.
      EXPECT_NEAR(stiffness, here.stiffness, tolerance(1e-4) * here.stiffness + tolerance(10.0)) << distance;
    }
  }
}

TEST(CompressionLaw, IsTheMeasuredOneUpToItsLargestPressure) {
  for (const double linearity : {0.25, 0.33, 0.5, 0.95}) {
    const CompressionLaw law = measured(linearity);
    const double exponent = 2.0 / linearity - 1.0;
    double work = 0.0;
    constexpr int kParts = 2000;
    for (int k = 0; k < kParts; ++k) {
      const double share = (k + 0.5) / kParts, pressure = law(kFree - share * (kFree - kPressed)).pressure;
      // The barrier may add 1 % below P_m; it begins at Tm, so it adds nothing.
      EXPECT_NEAR(pressure, 4903.325 * std::pow(share, exponent), tolerance(1e-9) * 4903.325);
      work += pressure * (kFree - kPressed) / kParts;
    }
    EXPECT_NEAR(law(kPressed).pressure, 4903.325, tolerance(1e-9) * 4903.325);
    // WC in gf·cm/cm² is 2.5 LC (T0 - Tm) with lengths in mm, and 1 gf·cm/cm² = 0.980665 J/m².
    const double expected = 0.980665 * 2.5 * linearity * 1e3 * (kFree - kPressed);
    EXPECT_NEAR(work, expected, tolerance(1e-2) * expected);
    EXPECT_NEAR(law(kPressed).energy, expected, tolerance(1e-9) * expected);
  }
}

TEST(CompressionLaw, BeginsSmoothlyAndHasNoBound) {
  for (const CompressionLaw& law : {measured(0.25), measured(0.95), unmeasured()}) {
    EXPECT_EQ(law.range(), kFree);
    for (const double apart : {kFree, 1.5 * kFree}) {
      const CompressionLaw::Point none = law(apart);
      EXPECT_EQ(none.energy, 0.0);
      EXPECT_EQ(none.pressure, 0.0);
      EXPECT_EQ(none.stiffness, 0.0);
    }
    // The slope is continuous: it hardly changes over a millionth of the range.
    for (const double place : {kFree, kPressed}) {
      const double most = law(kPressed).stiffness + law(0.5 * kFree).stiffness;
      const double below = law(place - 1e-6 * kFree).stiffness, above = law(place + 1e-6 * kFree).stiffness;
      EXPECT_LT(std::abs(below - above), tolerance(0.3) * most);
    }
    double last = 0.0;
    for (double distance = kFree; distance > 1e-15; distance *= 0.7) {
      const CompressionLaw::Point point = law(distance);
      EXPECT_TRUE(std::isfinite(point.energy) && std::isfinite(point.stiffness));
      EXPECT_GE(point.pressure, last);
      last = point.pressure;
    }
    EXPECT_GT(last, 1e12);  // the barrier is at least P_b Tm/g
  }
}

/// Beyond P_m the law of the test is a line of slope (2/LC - 1) P_m/(T0 - Tm). What it stores there is a
/// polynomial of second degree; the barrier stores P_m Tm (-v²/2 - v - ln(1 - v)), v = 1 - g/Tm. At the
/// least room of a mesh change the line has stored P_m Tm.
TEST(CompressionLaw, GoesOnStraightBeyondTheTest) {
  constexpr double kMost = 4903.325;  // P_m [Pa]
  for (const double linearity : {0.05, 0.33, 0.95}) {
    const CompressionLaw law = measured(linearity);
    const double slope = (2.0 / linearity - 1.0) * kMost / (kFree - kPressed);
    const auto beyond = [&](double distance) {
      const double way = kPressed - distance;
      return kMost * way + 0.5 * slope * way * way;
    };
    for (double distance = 0.05 * kPressed; distance < kPressed; distance += 0.1 * kPressed) {
      const double v = 1.0 - distance / kPressed;
      const double energy =
          law(kPressed).energy + beyond(distance) + kMost * kPressed * (-0.5 * v * v - v - std::log(1.0 - v));
      EXPECT_NEAR(law(distance).energy, energy, tolerance(1e-9) * energy);
    }
    EXPECT_NEAR(beyond(law.leastRoom()), kMost * kPressed, tolerance(1e-9) * kMost * kPressed);
  }
  EXPECT_EQ(unmeasured().leastRoom(), 0.0);
}

TEST(CompressionLaw, WithoutMeasurementIsTheContactLawWithoutItsLinearEnd) {
  const CompressionLaw law = unmeasured();
  const ContactLaw contact(kFree);
  for (double u = 0.01; u < ContactLaw::kSwitch; u += 0.01) {
    const double distance = (1.0 - u) * kFree;
    EXPECT_NEAR(law(distance).energy, contact(distance).energy, tolerance(1e-9) * contact(distance).energy);
    EXPECT_NEAR(law(distance).pressure, contact(distance).pressure, 1e-9 * contact(distance).pressure);
    EXPECT_NEAR(law(distance).stiffness, contact(distance).stiffness, 1e-9 * contact(distance).stiffness);
  }
  EXPECT_GT(law(0.01 * kFree).pressure, contact(0.01 * kFree).pressure);
}

}  // namespace
}  // namespace haptic_cloth::compression_law_test
