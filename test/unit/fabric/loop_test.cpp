// Hysteresis as play: every inner path stays in the loop, closes, dissipates and does not ratchet;
// ψ is C1 and its derivative is the law, also across the kinks. Criteria: properties of the play
// operator [Visintin 1994, III.2], to round-off; outer loops to 1 % of the scale of their width
// [docs/model.md].
#include "haptic_cloth/loop.h"

#include <gtest/gtest.h>

#include <cmath>
#include <vector>

#include "haptic_cloth/error.h"
#include "haptic_cloth/fabric.h"
#include "support/derivatives.h"
#include "support/tolerance.h"

namespace haptic_cloth::loop_test {
namespace {

/// Law like that of bending: lines of slope 2, half width 5, |s| <= 256; or like tension: powers
/// that meet at 0 and at the end.
Loop bending() {
  std::vector<double> upper, lower;
  for (int k = -512; k <= 512; ++k) {
    upper.push_back(2.0 * k * 0.5 + 5.0);
    lower.push_back(2.0 * k * 0.5 - 5.0);
  }
  return Loop(-256.0, 0.5, upper, lower, 20.0);
}

/// Rigid-plastic law: level branches, which the path crosses within 12.8.
Loop rigidPlastic() { return Loop(-256.0, 256.0, {5.0, 5.0, 5.0}, {-5.0, -5.0, -5.0}, 20.0, 12.8); }

Loop tensile() {
  std::vector<double> upper{-1.0}, lower{-1.0};
  for (int k = 0; k <= 512; ++k) {
    upper.push_back(490.0 * std::pow(k / 512.0, 2.3));
    lower.push_back(490.0 * std::pow(k / 512.0, 4.3));
  }
  return Loop(-0.06 / 512, 0.06 / 512, upper, lower, 3.0);
}

struct Case {
  const char* name;
  Loop loop;
  double low, high, scale;  // range of deformations; scale of the force
};

class LoopTest : public ::testing::TestWithParam<int> {
 protected:
  Case get() const {
    if (GetParam() == 0) return {"bending", bending(), -250, 250, 500};
    if (GetParam() == 1) return {"tensile", tensile(), -0.005, 0.065, 490};
    return {"rigid-plastic", rigidPlastic(), -250, 250, 5};
  }
  double at(const Case& c, double t) const { return c.low + (0.5 + 0.5 * t) * (c.high - c.low); }
};

TEST_P(LoopTest, StaysWithinTheLoop) {
  const Case c = get();
  const Eigen::VectorXd path = fixedRandom(5000, 1);
  double play = c.loop.initialPlay();
  for (int k = 0; k < path.size(); ++k) {
    const double s = at(c, path[k]);
    play = c.loop.commit(play, s);
    const double force = c.loop.force(play, s);
    // No play is so large that the force exceeds the upper branch.
    EXPECT_LE(force, c.loop.upper()(s).force + tolerance(1e-9) * c.scale);
  }
}

TEST_P(LoopTest, ForceIsTheDerivativeOfThePotential) {
  const Case c = get();
  const Eigen::VectorXd path = fixedRandom(400, 2), probe = fixedRandom(400, 3);
  double play = c.loop.initialPlay();
  const double d = 1e-7 * (c.high - c.low);
  for (int k = 0; k < path.size(); ++k) {
    play = c.loop.commit(play, at(c, path[k]));
    const Loop::Step step = c.loop.begin(play);
    const double s = at(c, probe[k]);
    const double slope = (c.loop(step, s + d).potential - c.loop(step, s - d).potential) / (2 * d);
    EXPECT_NEAR(c.loop(step, s).force, slope, tolerance(1e-4) * c.scale) << c.name;
    EXPECT_NEAR(c.loop(step, s).force, c.loop.force(play, s), tolerance(1e-9) * c.scale) << c.name;
    for (const double kink : {step.low, step.high}) {  // ψ and f are continuous across the kinks
      EXPECT_NEAR(c.loop(step, kink - 1e-12).force, c.loop(step, kink + 1e-12).force,
                  tolerance(1e-7) * c.scale);
      EXPECT_NEAR(c.loop(step, kink - d).potential, c.loop(step, kink + d).potential,
                  tolerance(4 * d * c.scale));
    }
  }
}

TEST_P(LoopTest, ClosedCyclesDissipateAndDoNotRatchet) {
  const Case c = get();
  double play = c.loop.commit(c.loop.initialPlay(), at(c, 0.4));
  std::vector<double> forces;
  double loss = 0.0, s = at(c, 0.4);
  for (int cycle = 0; cycle < 1000; ++cycle) {
    double work = 0.0;
    for (int k = 1; k <= 40; ++k) {
      const double next = at(c, 0.4 + 0.02 * std::sin(2 * M_PI * k / 40));
      const Loop::Step step = c.loop.begin(play);
      work += c.loop(step, next).potential - c.loop(step, s).potential;
      play = c.loop.commit(play, next);
      s = next;
    }
    EXPECT_GE(work, -tolerance(1e-12) * c.scale * (c.high - c.low));
    loss = work;
    forces.push_back(c.loop.force(play, s));
  }
  EXPECT_NEAR(forces[1], forces.back(), tolerance(1e-10) * c.scale);
  EXPECT_GE(loss, -tolerance(1e-12));
}

TEST_P(LoopTest, WorkIsNeverLessThanWhatIsStored) {
  const Case c = get();
  const Eigen::VectorXd path = fixedRandom(2000, 5);
  double play = c.loop.initialPlay(), s = 0.0, dissipated = 0.0;
  for (int k = 0; k < path.size(); ++k) {
    const double to = at(c, path[k]);
    const double from = s;
    // Small steps, because a jump dissipates what it skips.
    for (int part = 1; part <= 100; ++part) {
      const double next = from + (to - from) * part / 100;
      const Loop::Step step = c.loop.begin(play);
      const double before = c.loop.stored(play, s);
      const double work = c.loop(step, next).potential - c.loop(step, s).potential;
      play = c.loop.commit(play, next);
      dissipated += work - (c.loop.stored(play, next) - before);
      s = next;
    }
  }
  EXPECT_GT(dissipated, 0.0);
}

INSTANTIATE_TEST_SUITE_P(All, LoopTest, ::testing::Values(0, 1, 2));

TEST(LoopTest, FullBendingCycleHasTheMeasuredLoss) {
  // The loss of a full cycle is width · range, minus the two corners that the finite stiffness
  // after a reversal cuts off: each a triangle-like strip of width 2HB/(reversal - 1)/B.
  const Loop loop = bending();
  double play = loop.initialPlay(), s = 0.0, work = 0.0;
  const auto go = [&](double to) {
    const double from = s;
    for (int k = 1; k <= 2000; ++k) {
      const double next = from + (to - from) * k / 2000;
      const Loop::Step step = loop.begin(play);
      work += loop(step, next).potential - loop(step, s).potential;
      play = loop.commit(play, next);
      s = next;
    }
  };
  go(250);
  go(-250);
  go(250);
  work = 0.0;
  go(-250);
  go(250);
  EXPECT_NEAR(work, 10.0 * 500.0, tolerance(0.01) * 5000.0);
}

TEST(LoopTest, PathIsSteepEnoughForTheLongestCrossing) {
  const Loop loop = rigidPlastic();
  const double play = loop.commit(loop.commit(0.0, 250.0), 250.0 - 12.8);
  EXPECT_NEAR(loop.force(loop.commit(0.0, 250.0), 250.0), 5.0, tolerance(1e-12));
  EXPECT_NEAR(loop.force(play, 250.0 - 12.8), -5.0, tolerance(1e-4));  // 1e-6 of the path is left
}

TEST(LoopTest, OddLoopIsOddPastItsEnds) {
  // Cloth must respond to its mirror image in the same way, where a shear angle changes its sign;
  // to round-off.
  const Loop shear = loadFabric(HAPTIC_CLOTH_SOURCE_DIR "/config/fabrics/winter_suiting.yaml").shear;
  for (const double play : {-0.5, 0.0, 0.5}) {
    for (double s = -0.5; s <= 0.5; s += 0.01) {
      const double there = shear(shear.begin(play), s).force, mirrored = -shear(shear.begin(-play), -s).force;
      EXPECT_NEAR(there, mirrored, tolerance(1e-9) * (1.0 + std::abs(there))) << play << " at " << s;
    }
  }
}

TEST(LoopTest, ElasticLawHasNoMemory) {
  const Loop loop(Curve::linear(3.0));
  EXPECT_FALSE(loop.hasMemory());
  EXPECT_EQ(loop.force(loop.commit(0.0, 5.0), 2.0), 6.0);
  const Loop degenerate(0.0, 1.0, {0.0, 1.0}, {0.0, 1.0}, 5.0);
  EXPECT_FALSE(degenerate.hasMemory());
  EXPECT_TRUE(Loop().isZero());
}

TEST(LoopTest, RefusesBranchesThatCross) {
  EXPECT_THROW(Loop(0.0, 1.0, {0.0, 1.0, 2.0}, {0.0, 1.1, 1.5}, 5.0), InputError);
}

TEST(LoopTest, HandsForceOver) {
  const Loop loop = bending();
  for (const double s : {-100.0, 0.0, 30.0}) {
    for (const double force : {2 * s - 4.9, 2 * s, 2 * s + 4.9}) {
      EXPECT_NEAR(loop.force(loop.playFor(force, s), s), force, tolerance(1e-9));
    }
    EXPECT_NEAR(loop.force(loop.playFor(2 * s + 50.0, s), s), 2 * s + 5.0, tolerance(1e-9));
  }
}

}  // namespace
}  // namespace haptic_cloth::loop_test
