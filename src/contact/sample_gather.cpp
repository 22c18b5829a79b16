#include "contact/sample_gather.h"

#include "mesh/list_by_node.h"

namespace haptic_cloth {

void SampleGather::reserve(int nodes, int samples) {
  rows_.reserve(nodes + 2);
  entries_.reserve(4 * static_cast<std::size_t>(samples));
}

void SampleGather::rebuild(const SampleList& samples, int nodes) {
  const auto visit = [&](const auto& put) {
    for (int k = 0; k < samples.size(); ++k) {
      for (int c = 0; c < 4; ++c) {
        if (samples[k].area > 0.0 && samples[k].weights[c] > 0.0)
          put(samples[k].nodes[c], Entry{k, samples[k].weights[c]});
      }
    }
  };
  listByNode(nodes, visit, rows_, entries_);
}

void SampleGather::add(int begin, int end, const Field& of_samples, Field& of_nodes) const {
  for (int n = begin; n < end; ++n) {
    if (rows_[n] == rows_[n + 1]) continue;
    Vec3 sum = of_nodes[n];
    for (int e = rows_[n]; e < rows_[n + 1]; ++e) sum += entries_[e].weight * of_samples[entries_[e].sample];
    of_nodes.set(n, sum);
  }
}

}  // namespace haptic_cloth
