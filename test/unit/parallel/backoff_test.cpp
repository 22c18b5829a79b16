/// Steps that use one thread. Criteria: the rules in Backoff's comment. Only the order of the
/// numbers of runs is checked, so the constants may change.
#include <gtest/gtest.h>

#include "parallel/parallel_for.h"

namespace haptic_cloth {
namespace {

/// Counts the runs with one thread until the next region is allowed.
int runsAlone(Backoff& backoff) {
  int runs = 0;
  while (backoff.alone()) ++runs;
  return runs;
}

TEST(Backoff, LetsQuietRegionsFollowEachOther) {
  Backoff backoff;
  for (int region = 0; region < 10; ++region) {
    EXPECT_EQ(runsAlone(backoff), 0);
    backoff.note(0.1e-3, 1e-3);
  }
}

TEST(Backoff, WaitsLongerWithEachCrowdedRegion) {
  Backoff backoff;
  int last = 0;
  for (int region = 0; region < 5; ++region) {
    backoff.note(0.6e-3, 1e-3);
    const int runs = runsAlone(backoff);
    EXPECT_GT(runs, last);
    last = runs;
  }
}

TEST(Backoff, KeepsTryingOnACrowdedMachine) {
  Backoff backoff;
  for (int region = 0; region < 100; ++region) {
    backoff.note(1e-3, 1e-3);
    EXPECT_LT(runsAlone(backoff), 1000);  // one second of steps of 1 ms
  }
}

TEST(Backoff, StartsOverAfterAQuietRegion) {
  Backoff backoff;
  backoff.note(1e-3, 1e-3);
  const int first = runsAlone(backoff);
  for (int region = 0; region < 5; ++region) backoff.note(1e-3, 1e-3);
  runsAlone(backoff);
  backoff.note(0.0, 1e-3);
  EXPECT_EQ(runsAlone(backoff), 0);
  backoff.note(1e-3, 1e-3);
  EXPECT_EQ(runsAlone(backoff), first);
}

}  // namespace
}  // namespace haptic_cloth
