/// Order in which threads take the blocks of a list.
#pragma once

#include <algorithm>
#include <utility>
#include <vector>

namespace haptic_cloth {

/// Orders the blocks of a list that consists of several arrays, each sorted along the cloth: blocks that
/// begin at the same share of their arrays follow one another. A thread takes consecutive blocks, so it
/// works on one part of the cloth in all arrays and finds in its cache what it wrote. Without arrays the
/// blocks are taken as they are numbered.
class BlockOrder {
 public:
  static constexpr int kBlock = 256;  ///< entries of a block

  static int blocks(int count) { return (count + kBlock - 1) / kBlock; }

  void clear() { order_.clear(); }

  /// @param starts where the arrays begin in the list, ascending from 0
  /// @param count length of the list
  template <class Starts>
  void set(const Starts& starts, int count) {
    keys_.clear();
    auto start = std::begin(starts);
    for (int block = 0; block < blocks(count); ++block) {
      const int first = block * kBlock;
      while (std::next(start) != std::end(starts) && *std::next(start) <= first) ++start;
      const int end = std::next(start) == std::end(starts) ? count : *std::next(start);
      keys_.push_back({static_cast<double>(first - *start) / (end - *start), block});
    }
    std::sort(keys_.begin(), keys_.end());
    order_.clear();
    for (const auto& key : keys_) order_.push_back(key.second);
  }

  /// Block to be taken at a position.
  int operator[](int position) const { return order_.empty() ? position : order_[position]; }

  void reserve(int count) {
    keys_.reserve(blocks(count));
    order_.reserve(blocks(count));
  }

 private:
  std::vector<std::pair<double, int>> keys_;  ///< share of the array at which a block begins, and its number
  std::vector<int> order_;
};

}  // namespace haptic_cloth
