/// Selected parts of an index range, divided over threads as if they were contiguous.
#pragma once

#include <algorithm>
#include <vector>

namespace haptic_cloth {

class Runs {
 public:
  void reserve(int runs) { runs_.reserve(runs); }
  void clear() {
    runs_.clear();
    size_ = 0;
  }

  /// Appends begin..end. @pre begin is at or after the last end
  void add(int begin, int end) {
    if (begin >= end) return;
    if (!runs_.empty() && runs_.back().end == begin) {
      runs_.back().end = end;
    } else {
      runs_.push_back({begin, end, size_});
    }
    size_ += end - begin;
  }

  /// Number of indices in all runs.
  int size() const { return size_; }

  /// Calls work(begin, end) for the parts of the runs that make up from..to of 0..size().
  template <class Work>
  void forPart(int from, int to, const Work& work) const {
    auto run = std::upper_bound(runs_.begin(), runs_.end(), from,
                                [](int index, const Run& r) { return index < r.first; });
    if (run != runs_.begin()) --run;
    for (; run != runs_.end() && run->first < to; ++run) {
      const int shift = run->begin - run->first;
      work(std::max(from + shift, run->begin), std::min(to + shift, run->end));
    }
  }

 private:
  struct Run {
    int begin, end;
    int first;  ///< index of `begin` among all runs
  };
  std::vector<Run> runs_;
  int size_ = 0;
};

}  // namespace haptic_cloth
