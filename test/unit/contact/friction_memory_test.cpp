/// Memory of friction.
/// Criteria: what was remembered at a point is found there bit for bit, for its solid only; a new
/// point finds the nearest sample that stood for it, and nothing where none stood.
#include "contact/friction_memory.h"

#include <gtest/gtest.h>

#include "contact/friction_law.h"
#include "haptic_cloth/error.h"
#include "state/archive.h"
#include "support/tolerance.h"

namespace haptic_cloth::friction_memory_test {
namespace {

const Grid kGrid{9, 17, 2, 0.004, 0.005};
const Vec3 kPull(0.3, -0.4, 0.1), kOther(-0.6, 0.2, 0.0);

TEST(FrictionMemory, FindsWhatWasRememberedAtAPoint) {
  FrictionMemory memory(kGrid);
  EXPECT_EQ(memory.find(0, {3.0, 4.0}), Vec3::Zero());
  // Points of a probe, four in a finest cell, and the last particle.
  memory.add(0, {3.25, 4.25}, 0.25, kPull);
  memory.add(0, {3.75, 4.25}, 0.25, kOther);
  memory.add(1, {3.25, 4.25}, 0.25, -kPull);
  memory.add(1, {8.0, 16.0}, 0.5, kOther);
  EXPECT_EQ(memory.find(0, {3.25, 4.25}), kPull);
  EXPECT_EQ(memory.find(0, {3.75, 4.25}), kOther);
  EXPECT_EQ(memory.find(1, {3.25, 4.25}), -kPull);
  EXPECT_EQ(memory.find(1, {8.0, 16.0}), kOther);
  EXPECT_EQ(memory.find(0, {8.0, 16.0}), Vec3::Zero()) << "another solid";
  EXPECT_EQ(memory.find(1, {3.75, 4.25}), Vec3::Zero()) << "half a cell away";
  memory.clear();
  EXPECT_EQ(memory.find(0, {3.25, 4.25}), Vec3::Zero());
}

TEST(FrictionMemory, NewPointsFindTheSampleThatStoodForThem) {
  FrictionMemory memory(kGrid);
  memory.add(0, {0.0, 0.0}, 2.0, kPull);  // nodes of cells of four finest cells
  memory.add(0, {4.0, 0.0}, 2.0, kOther);
  EXPECT_EQ(memory.find(0, {1.0, 1.0}), kPull);
  EXPECT_EQ(memory.find(0, {3.0, 2.0}), kOther);
  EXPECT_EQ(memory.find(0, {1.0, 2.5}), Vec3::Zero()) << "beyond both";
}

TEST(FrictionMemory, IsSavedAndLoaded) {
  FrictionMemory memory(kGrid), other(kGrid);
  memory.add(0, {3.25, 4.25}, 0.25, kPull);
  memory.add(1, {0.0, 16.0}, 0.5, kOther);
  other.add(0, {5.0, 5.0}, 0.5, kOther);
  Archive saving;
  memory.serialize(saving, 2);
  Archive loading(saving.sealed(), "state");
  other.serialize(loading, 2);
  loading.finish();
  EXPECT_EQ(other.find(0, {3.25, 4.25}), kPull);
  EXPECT_EQ(other.find(1, {0.0, 16.0}), kOther);
  EXPECT_EQ(other.find(0, {5.0, 5.0}), Vec3::Zero()) << "what was there before";
  Archive refused(saving.sealed(), "state");
  EXPECT_THROW(other.serialize(refused, 1), InputError) << "there is no second solid";
}

/// A force below μN is held at the slip y of f0'(y) = F/N: the next step starts there and finds the
/// same balance. Beyond μN the slip is ε, from where on it slides.
TEST(SlipUnder, IsTheInverseOfTheForce) {
  constexpr double kEpsilon = 3e-7;
  const Vec3 direction(0.6, 0.0, -0.8);
  for (const double share : {0.0, 1e-6, 0.1, 0.5, 0.99, 1.0}) {
    const Vec3 slip = kEpsilon * slipUnder(share * direction);
    const Vec3 force = smoothSlip(slip.norm(), kEpsilon).ratio * slip;
    EXPECT_NEAR((force - share * direction).norm(), 0.0, tolerance(1e-12));
  }
  EXPECT_NEAR((slipUnder(7.0 * direction) - direction).norm(), 0.0, tolerance(1e-15));
}

}  // namespace
}  // namespace haptic_cloth::friction_memory_test
