/// Gathering of the samples' forces at the nodes.
#pragma once

#include <vector>

#include "contact/sample_list.h"
#include "mesh/field.h"

namespace haptic_cloth {

/// Samples of each node in a fixed order, so that the bits of the sums do not depend on the number
/// of threads.
class SampleGather {
 public:
  void reserve(int nodes, int samples);
  void rebuild(const SampleList& samples, int nodes);

  /// Adds the values of their samples to nodes begin..end, times the weights.
  void add(int begin, int end, const Field& of_samples, Field& of_nodes) const;

  /// Calls visit(sample, weight) for the samples of a node.
  template <class Visit>
  void forSamples(int node, const Visit& visit) const {
    for (int e = rows_[node]; e < rows_[node + 1]; ++e) visit(entries_[e].sample, entries_[e].weight);
  }

 private:
  struct Entry {
    int sample;
    double weight;
  };

  std::vector<int> rows_;  ///< entries of node n: rows_[n] .. rows_[n + 1]
  std::vector<Entry> entries_;
};

}  // namespace haptic_cloth
