/// Two calls at once. Criteria: what Team::runBeside() promises.
#include <gtest/gtest.h>

#include <atomic>
#include <chrono>
#include <stdexcept>
#include <thread>

#include "parallel/parallel_for.h"

namespace haptic_cloth::team_test {
namespace {

constexpr int kMany = 100000;  // particles, so that a region uses as many threads as it may

class TeamOf : public testing::TestWithParam<int> {};

INSTANTIATE_TEST_SUITE_P(Threads, TeamOf, testing::Values(1, 2, 3));

TEST_P(TeamOf, MakesBothCallsAndTheLoopsOfOne) {
  constexpr int kCalls = 1000;  // each meets the other threads in another state
  Team team(GetParam());
  long calls = 0, items = 0;
  const auto callBoth = [&] {
    long task = 0;
    const auto count = [](int begin, int end) {
      Sums sums = Sums::Zero();
      sums[0] = end - begin;
      return sums;
    };
    team.runBeside([&] { task = 1; }, [&] { items += static_cast<long>(team.sum(kMany, count)[0]); });
    calls += task;
  };
  callBoth();  // outside a region
  team.run(kMany, [&] {
    for (int k = 0; k < kCalls; ++k) callBoth();
  });
  EXPECT_EQ(calls, kCalls + 1);
  EXPECT_EQ(items, long{kMany} * (kCalls + 1));
}

TEST_P(TeamOf, EndsTheOtherCallIfOneThrows) {
  Team team(GetParam());
  bool ended = false;
  const auto fail = [] { throw std::runtime_error("of the body"); };
  EXPECT_THROW(team.run(kMany, [&] { team.runBeside([&] { ended = true; }, fail); }), std::runtime_error);
  // Outside a region nothing has begun before the body, so nothing is left to end.
  EXPECT_EQ(ended, GetParam() > 1);
}

TEST(Team, MakesTwoCallsAtOnce) {
  Team team(2);
  std::atomic<bool> begun{false};
  std::thread::id other;
  team.run(kMany, [&] {
    const auto deadline = std::chrono::steady_clock::now() + std::chrono::minutes(1);  // for a busy machine
    team.runBeside(
        [&] {
          other = std::this_thread::get_id();
          begun = true;
        },
        [&] {
          while (!begun && std::chrono::steady_clock::now() < deadline) std::this_thread::yield();
        });
  });
  EXPECT_NE(other, std::this_thread::get_id());
}

}  // namespace
}  // namespace haptic_cloth::team_test
