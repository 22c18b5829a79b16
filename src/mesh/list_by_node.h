/// Lists of entries that belong to nodes.
#pragma once

#include <vector>

namespace haptic_cloth {

/// Sorts entries by their nodes and keeps their order at each: those of node n are entries[rows[n]] ..
/// entries[rows[n + 1] - 1]. `rows` takes nodes + 2 numbers.
/// @param forEntries calls put(node, entry) for each entry, with the same entries each time
template <class Entry, class ForEntries>
void listByNode(int nodes, const ForEntries& forEntries, std::vector<int>& rows,
                std::vector<Entry>& entries) {
  rows.assign(nodes + 2, 0);
  forEntries([&](int n, const Entry&) { ++rows[n + 2]; });
  for (int n = 0; n < nodes; ++n) rows[n + 2] += rows[n + 1];
  entries.resize(rows[nodes + 1]);
  forEntries([&](int n, const Entry& entry) { entries[rows[n + 1]++] = entry; });
}

}  // namespace haptic_cloth
