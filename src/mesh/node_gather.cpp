#include "mesh/node_gather.h"

#include <algorithm>

namespace haptic_cloth {
namespace {

// What a node is to an element. Nodes in a row of equal cells have one element of each role, and those follow
// one another too.
constexpr int kEdgeRoles = 0, kTripleRoles = 4, kPatchRoles = 10, kTwistRoles = 14;

template <class Element>
PackedRange count(const std::vector<Element>& elements) {
  PackedRange range;
  for (const Element& element : elements) ++(element.direction == kWarp ? range.warp : range.weft);
  return range;
}

}  // namespace

NodeGather::NodeGather(const ActiveMesh& mesh, const Kinds& kinds) : kinds_(kinds) {
  const std::size_t n = mesh.grid.particles();
  const std::size_t entries = 2 * mesh.edges.capacity() + (kinds.bending ? 3 * mesh.triples.capacity() : 0) +
                              ((kinds.shear ? 4 : 0) + (kinds.twist ? 4 : 0)) * mesh.patches.capacity();
  rows_.reserve(n + 2);
  entries_.reserve(entries);
  groups_.reserve(n / kLanes + 2);
  columns_.reserve(entries);
  details_.reserve(entries / 2);
  rebuild(mesh);
}

int NodeGather::capacity(const ActiveMesh& mesh) {
  return static_cast<int>(mesh.edges.capacity() + mesh.triples.capacity() + 3 * mesh.patches.capacity()) +
         8 * kLanes;
}

void NodeGather::rebuild(const ActiveMesh& mesh) {
  edges_ = count(mesh.edges);
  triples_ = kinds_.bending ? count(mesh.triples) : PackedRange();
  patches_ = {kinds_.shear || kinds_.twist ? static_cast<int>(mesh.patches.size()) : 0, 0};
  listEntries(mesh);
  groups_.assign(1, 0);
  columns_.clear();
  details_.clear();
  for (int first = 0; first < mesh.nodes(); first += kLanes) {
    addGroup(first, std::min(kLanes, mesh.nodes() - first));
    groups_.push_back(static_cast<int>(columns_.size()));
  }
}

/// Counts, then fills, as compressed rows.
void NodeGather::listEntries(const ActiveMesh& mesh) {
  const auto visit = [&](const auto& put) {
    for (int e = 0; e < edges_.warp + edges_.weft; ++e) {
      const Edge& edge = mesh.edges[e];
      const int role = kEdgeRoles + 2 * edge.direction, slot = edges_.place(e);
      put(edge.b, Entry{role, slot, 1.0});
      put(edge.a, Entry{role + 1, slot, -1.0});
    }
    for (int t = 0; t < triples_.warp + triples_.weft; ++t) {
      const Triple& triple = mesh.triples[t];
      const int role = kTripleRoles + 3 * triple.direction, slot = firstTriple() + triples_.place(t);
      put(triple.r, Entry{role, slot, triple.right});
      put(triple.c, Entry{role + 1, slot, -(triple.left + triple.right)});
      put(triple.l, Entry{role + 2, slot, triple.left});
    }
    for (int k = 0; k < patches_.warp; ++k) {
      const auto& n = mesh.patches[k].nodes;
      const int rising = firstPatch() + k, falling = rising + patches_.size(), twist = firstTwist() + k;
      for (int c = 0; c < 4; ++c) {
        const bool diagonal = c == 0 || c == 3;
        if (kinds_.shear) {
          put(n[c], Entry{kPatchRoles + c, diagonal ? rising : falling, c == 1 || c == 3 ? 1.0 : -1.0});
        }
        if (kinds_.twist) put(n[c], Entry{kTwistRoles + c, twist, diagonal ? 1.0 : -1.0});
      }
    }
  };
  rows_.assign(mesh.nodes() + 2, 0);
  visit([&](int n, const Entry&) { ++rows_[n + 2]; });
  for (int n = 0; n < mesh.nodes(); ++n) rows_[n + 2] += rows_[n + 1];
  entries_.resize(rows_[mesh.nodes() + 1]);
  visit([&](int n, const Entry& entry) { entries_[rows_[n + 1]++] = entry; });
  for (int n = 0; n < mesh.nodes(); ++n) {
    std::sort(
        entries_.begin() + rows_[n], entries_.begin() + rows_[n + 1],
        [](const Entry& a, const Entry& b) { return a.role != b.role ? a.role < b.role : a.slot < b.slot; });
  }
}

/// Columns of up to eight nodes: role by role, and again where a node has several of one.
void NodeGather::addGroup(int first_node, int nodes) {
  std::array<int, kLanes> next;
  for (int l = 0; l < nodes; ++l) next[l] = rows_[first_node + l];
  while (true) {
    int role = 1 << 30;
    for (int l = 0; l < nodes; ++l) {
      if (next[l] < rows_[first_node + l + 1]) role = std::min(role, entries_[next[l]].role);
    }
    if (role == 1 << 30) return;
    std::array<const Entry*, kLanes> entries{};
    for (int l = 0; l < nodes; ++l) {
      const bool has = next[l] < rows_[first_node + l + 1] && entries_[next[l]].role == role;
      if (has) entries[l] = &entries_[next[l]++];
    }
    addColumn(entries, nodes);
  }
}

/// @param nodes lanes with a node; the others may take anything
void NodeGather::addColumn(const std::array<const Entry*, kLanes>& entries, int nodes) {
  const auto present = std::find_if(entries.begin(), entries.end(), [](const Entry* e) { return e; });
  const int first = (*present)->slot - static_cast<int>(present - entries.begin());
  const double coefficient = (*present)->coefficient;
  const bool fits = first >= 0 && first + kLanes <= slots();
  bool in_row = fits, alike = fits;
  for (int l = 0; l < nodes; ++l) {
    in_row = in_row && (!entries[l] || entries[l]->slot == first + l);
    alike = alike && entries[l] && entries[l]->coefficient == coefficient;
  }
  if (in_row && alike) {
    columns_.push_back({first, -1, coefficient});
    return;
  }
  Detail detail{};
  for (int l = 0; l < kLanes; ++l) {
    detail.slots.index[l] = in_row ? first + l : entries[l] ? entries[l]->slot : (*present)->slot;
    detail.coefficient[l] = entries[l] ? entries[l]->coefficient : 0.0;
  }
  detail.slots.finish();
  columns_.push_back({first, static_cast<int>(details_.size()), 0.0});
  details_.push_back(detail);
}

void NodeGather::add(int begin, int end, const Field& slots, Field& nodes) const {
  for (int n = begin; n < end; n += kLanes) {
    const int group = n / kLanes;
    addColumns(columns_.data() + groups_[group], columns_.data() + groups_[group + 1], details_.data(),
               slots.arrays(), nodes.arrays(), n);
  }
}

HAPTIC_CLOTH_CLONES void NodeGather::addColumns(const Column* begin, const Column* end, const Detail* details,
                                                const ConstArrays& slots, const MutableArrays& nodes,
                                                int first_node) {
  Lanes3 sum = load(ConstArrays(nodes), first_node);
  for (const Column* column = begin; column != end; ++column) {
    if (column->detail < 0) {
      sum = sum + all(column->coefficient) * load(slots, column->first);
    } else {
      const Detail& detail = details[column->detail];
      sum = sum + load(detail.coefficient) * gather(slots, detail.slots);
    }
  }
  store(nodes, first_node, sum);
}

}  // namespace haptic_cloth
