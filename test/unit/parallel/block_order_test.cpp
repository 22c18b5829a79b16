/// Order of blocks. Criteria: the definition in BlockOrder's comment.
#include "parallel/block_order.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <array>
#include <numeric>
#include <vector>

#include "parallel/parallel_for.h"

namespace haptic_cloth::block_order_test {
namespace {

constexpr int kBlock = BlockOrder::kBlock;

std::vector<int> listOf(const BlockOrder& order, int count) {
  std::vector<int> list;
  for (int position = 0; position < BlockOrder::blocks(count); ++position) list.push_back(order[position]);
  return list;
}

TEST(BlockOrder, AlternatesBetweenArraysOfOneLength) {
  BlockOrder order;
  order.set(std::array{0, 2 * kBlock, 4 * kBlock}, 6 * kBlock);
  EXPECT_EQ(listOf(order, 6 * kBlock), (std::vector<int>{0, 2, 4, 1, 3, 5}));
}

TEST(BlockOrder, KeepsShortArraysBesideLongOnes) {
  BlockOrder order;
  order.set(std::array{0, 4 * kBlock}, 6 * kBlock);  // the second array has two blocks
  EXPECT_EQ(listOf(order, 6 * kBlock), (std::vector<int>{0, 4, 1, 2, 5, 3}));
}

TEST(BlockOrder, HasEachBlockOnce) {
  const std::array starts{0, 0, 100, 100, 1700, 1701, 5000};  // empty arrays, and some shorter than a block
  for (const int count : {0, 1, kBlock, kBlock + 1, 5000, 5100, 12345}) {
    BlockOrder order;
    order.set(starts, count);
    std::vector<int> list = listOf(order, count), all(list.size());
    std::iota(all.begin(), all.end(), 0);
    std::sort(list.begin(), list.end());
    EXPECT_EQ(list, all) << count;
  }
}

TEST(BlockOrder, TakesBlocksAsNumberedUntilSetAndAfterClear) {
  BlockOrder order;
  EXPECT_EQ(listOf(order, 3 * kBlock), (std::vector<int>{0, 1, 2}));
  order.set(std::array{0, kBlock}, 3 * kBlock);
  order.clear();
  EXPECT_EQ(listOf(order, 3 * kBlock), (std::vector<int>{0, 1, 2}));
}

TEST(BlockOrder, ChangesNoBitOfASum) {
  constexpr int kCount = 40 * kBlock + 7;
  BlockOrder order;
  order.set(std::array{0, 13 * kBlock + 5, 30 * kBlock}, kCount);
  const auto work = [](int begin, int end) {
    Sums sums = Sums::Zero();
    for (int k = begin; k < end; ++k) sums[0] += 1.0 / (1 + k);
    return sums;
  };
  Team one(1), three(3);
  const double alone = one.sum(kCount, work)[0];
  three.run(1 << 20, [&] { EXPECT_EQ(three.sum(kCount, work, 1e-6, order)[0], alone); });
}

}  // namespace
}  // namespace haptic_cloth::block_order_test
