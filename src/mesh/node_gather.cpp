#include "mesh/node_gather.h"

#include <algorithm>

#include "mesh/list_by_node.h"
#include "simd/kernels.h"

namespace haptic_cloth {
namespace {

// Roles of a node in an element. Nodes in a row of equal cells have one element of each role, and
// these follow one another too.
constexpr int kTripleParts = 5;
constexpr int kEdgeRoles = 0, kTripleRoles = 4, kPatchRoles = kTripleRoles + 2 * kTripleParts,
              kTwistRoles = kPatchRoles + 4;

template <class Element>
PackedRange count(const std::vector<Element>& elements) {
  PackedRange range;
  for (const Element& element : elements) ++(element.direction == kWarp ? range.warp : range.weft);
  return range;
}

}  // namespace

NodeGather::NodeGather(const ActiveMesh& mesh, const Kinds& kinds) : kinds_(kinds) {
  const std::size_t n = mesh.grid.particles();
  const std::size_t entries = 2 * mesh.edges.capacity() +
                              (kinds.bending ? kTripleParts * mesh.triples.capacity() : 0) +
                              ((kinds.shear ? 4 : 0) + (kinds.twist ? 4 : 0)) * mesh.patches.capacity();
  rows_.reserve(n + 2);
  entries_.reserve(entries);
  groups_.reserve(n / kPack + 2);
  columns_.reserve(entries);
  details_.reserve(entries / 2);
  rebuild(mesh);
}

int NodeGather::capacity(const ActiveMesh& mesh) {
  return static_cast<int>(mesh.edges.capacity() + mesh.triples.capacity() + 3 * mesh.patches.capacity()) +
         8 * kPack;
}

void NodeGather::rebuild(const ActiveMesh& mesh) {
  edges_ = count(mesh.edges);
  triples_ = kinds_.bending ? count(mesh.triples) : PackedRange();
  patches_ = {kinds_.shear || kinds_.twist ? static_cast<int>(mesh.patches.size()) : 0, 0};
  listEntries(mesh);
  groups_.assign(1, 0);
  columns_.clear();
  details_.clear();
  for (int first = 0; first < mesh.nodes(); first += kPack) {
    addGroup(first, std::min(kPack, mesh.nodes() - first));
    groups_.push_back(static_cast<int>(columns_.size()));
  }
}

/// Calls put(node, entry) role by role, each in the order of the slots.
template <class Put>
void NodeGather::forEntries(const ActiveMesh& mesh, const Put& put) const {
  const int edge_ends[] = {0, edges_.warp, edges_.warp + edges_.weft},
            triple_ends[] = {0, triples_.warp, triples_.warp + triples_.weft};
  for (const int d : {kWarp, kWeft}) {
    const int role = kEdgeRoles + 2 * d;
    for (int e = edge_ends[d]; e < edge_ends[d + 1]; ++e) put(mesh.edges[e].b, {role, edges_.place(e), 1.0});
    for (int e = edge_ends[d]; e < edge_ends[d + 1]; ++e) {
      put(mesh.edges[e].a, {role + 1, edges_.place(e), -1.0});
    }
  }
  for (const int d : {kWarp, kWeft}) {
    const auto forTriples = [&](int part, int Triple::*node, const auto& coefficient) {
      for (int t = triple_ends[d]; t < triple_ends[d + 1]; ++t) {
        const Triple& triple = mesh.triples[t];
        const Entry entry{kTripleRoles + kTripleParts * d + part, firstTriple() + triples_.place(t),
                          coefficient(triple)};
        if (entry.coefficient != 0.0) put(triple.*node, entry);
      }
    };
    forTriples(0, &Triple::r, [](const Triple& t) { return t.right; });
    forTriples(1, &Triple::c, [](const Triple& t) { return t.centre(); });
    forTriples(2, &Triple::l, [](const Triple& t) { return t.left; });
    forTriples(3, &Triple::a, [](const Triple& t) { return -t.sagitta; });
    forTriples(4, &Triple::b, [](const Triple& t) { return -t.sagitta; });
  }
  for (int c = 0; kinds_.shear && c < 4; ++c) {
    const int first = firstPatch() + (c == 0 || c == 3 ? 0 : patches_.size());
    const double sign = c == 1 || c == 3 ? 1.0 : -1.0;
    for (int k = 0; k < patches_.warp; ++k) put(mesh.patches[k].nodes[c], {kPatchRoles + c, first + k, sign});
  }
  for (int c = 0; kinds_.twist && c < 4; ++c) {
    const double sign = c == 0 || c == 3 ? 1.0 : -1.0;
    for (int k = 0; k < patches_.warp; ++k) {
      put(mesh.patches[k].nodes[c], {kTwistRoles + c, firstTwist() + k, sign});
    }
  }
}

void NodeGather::listEntries(const ActiveMesh& mesh) {
  listByNode(
      mesh.nodes(), [&](const auto& put) { forEntries(mesh, put); }, rows_, entries_);
}

/// Adds the columns of a pack of nodes, role by role; a role that a node has several times takes
/// more columns.
void NodeGather::addGroup(int first_node, int nodes) {
  std::array<int, kPack> next;
  for (int l = 0; l < nodes; ++l) next[l] = rows_[first_node + l];
  while (true) {
    int role = 1 << 30;
    for (int l = 0; l < nodes; ++l) {
      if (next[l] < rows_[first_node + l + 1]) role = std::min(role, entries_[next[l]].role);
    }
    if (role == 1 << 30) return;
    std::array<const Entry*, kPack> entries{};
    for (int l = 0; l < nodes; ++l) {
      const bool has = next[l] < rows_[first_node + l + 1] && entries_[next[l]].role == role;
      if (has) entries[l] = &entries_[next[l]++];
    }
    addColumn(entries, nodes);
  }
}

/// Adds one column. @param nodes lanes that have a node; the others may have any value
void NodeGather::addColumn(const std::array<const Entry*, kPack>& entries, int nodes) {
  const auto present = std::find_if(entries.begin(), entries.end(), [](const Entry* e) { return e; });
  const int first = (*present)->slot - static_cast<int>(present - entries.begin());
  const double coefficient = (*present)->coefficient;
  const bool fits = first >= 0 && first + kPack <= slots();
  bool in_row = fits, alike = fits;
  for (int l = 0; l < nodes; ++l) {
    in_row = in_row && (!entries[l] || entries[l]->slot == first + l);
    alike = alike && entries[l] && entries[l]->coefficient == coefficient;
  }
  if (in_row && alike) {
    columns_.push_back({first, -1, coefficient});
    return;
  }
  GatherDetail detail{};
  for (int l = 0; l < kPack; ++l) {
    detail.slots.index[l] = in_row ? first + l : entries[l] ? entries[l]->slot : (*present)->slot;
    detail.coefficient[l] = entries[l] ? entries[l]->coefficient : 0.0;
  }
  detail.slots.finish();
  columns_.push_back({first, static_cast<int>(details_.size()), 0.0});
  details_.push_back(detail);
}

void NodeGather::add(int begin, int end, const Field& slots, Field& nodes) const {
  kernels().gatherColumns(groups_.data(), columns_.data(), details_.data(), begin, end, slots.arrays(),
                          nodes.arrays());
}

}  // namespace haptic_cloth
