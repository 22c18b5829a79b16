/// Steps that use one thread. Criteria: the rules in Backoff's comment. Only the order of the
/// numbers of runs is checked, so the constants may change.
#include <gtest/gtest.h>

#include "parallel/parallel_for.h"

namespace haptic_cloth::backoff_test {
namespace {

constexpr double kCost = 0.8;  // of loops on one thread, over their estimate: any number

/// Counts the runs with one thread until the next region is allowed.
int runsAlone(Backoff& backoff) {
  int runs = 0;
  while (backoff.alone()) ++runs;
  return runs;
}

constexpr Backoff::Region kQuiet{0.1e-3, 1e-3, 0.6 * kCost}, kCrowded{0.6e-3, 1e-3, 0.6 * kCost};

/// One that has measured loops on one thread.
Backoff measured() {
  Backoff backoff;
  for (bool alone = false; !alone;) {
    backoff.note(kQuiet);
    while (backoff.alone()) {
      backoff.noteAlone(kCost);
      alone = true;
    }
  }
  return backoff;
}

TEST(Backoff, LetsQuietRegionsFollowEachOther) {
  Backoff backoff = measured();
  for (int region = 0; region < 10; ++region) {
    EXPECT_EQ(runsAlone(backoff), 0);
    backoff.note(kQuiet);
  }
}

/// Of 10,000 steps, one in a hundred at most.
TEST(Backoff, MeasuresLoopsOnOneThreadNowAndThen) {
  Backoff backoff = measured();
  int alone = 0;
  for (int step = 0; step < 10000; ++step) {
    if (backoff.alone()) {
      backoff.noteAlone(kCost);
      ++alone;
    } else {
      backoff.note(kQuiet);
    }
  }
  EXPECT_GT(alone, 5);
  EXPECT_LT(alone, 100);
}

TEST(Backoff, WaitsLongerWithEachCrowdedRegion) {
  Backoff backoff = measured();
  int last = 0;
  for (int region = 0; region < 5; ++region) {
    backoff.note(kCrowded);
    const int runs = runsAlone(backoff);
    EXPECT_GT(runs, last);
    last = runs;
  }
}

TEST(Backoff, KeepsTryingOnACrowdedMachine) {
  Backoff backoff = measured();
  for (int region = 0; region < 100; ++region) {
    backoff.note(kCrowded);
    EXPECT_LT(runsAlone(backoff), 1000);  // one second of steps of 1 ms
  }
}

TEST(Backoff, StartsOverAfterQuietRegions) {
  Backoff backoff = measured();
  backoff.note(kCrowded);
  const int first = runsAlone(backoff);
  for (int region = 0; region < 5; ++region) backoff.note(kCrowded);
  runsAlone(backoff);
  for (int region = 0; region < 3; ++region) {
    backoff.note(kQuiet);
    EXPECT_EQ(runsAlone(backoff), 0);
  }
  backoff.note(kCrowded);
  EXPECT_EQ(runsAlone(backoff), first);
}

/// Steps on several threads, of 10,000 whose loops take so many times as long there as on one thread.
/// @param change from which step on they take 0.6 times as long
int shared(double cost, int change = 1 << 30) {
  Backoff backoff;
  int shared = 0;
  for (int step = 0; step < 10000; ++step) {
    if (backoff.alone()) {
      backoff.noteAlone(kCost);
    } else {
      backoff.note({0.0, 1e-3, (step < change ? cost : 0.6) * kCost});
      ++shared;
    }
  }
  return shared;
}

/// Measured, time on two threads over that on one, 5929 particles: 1.2 on two cores of an AMD EPYC 9004
/// without a common cache, 0.65 on two with one and on two of an Intel Xeon (Sapphire Rapids), whose cores
/// are as far from each other as those of the first.
TEST(Backoff, SharesLoopsThatTakeLessTimeThanOnOneThread) {
  EXPECT_LT(shared(1.2), 100);
  EXPECT_GT(shared(0.65), 9900);
}

/// A host may move the cores: then at most the longest wait, and as long again, is lost.
TEST(Backoff, NoticesThatSharingPaysNow) { EXPECT_GT(shared(1.2, 5000), 5000 - 1100); }

}  // namespace
}  // namespace haptic_cloth::backoff_test
