#include "mesh/mesh_change.h"

#include <algorithm>

namespace haptic_cloth {

MeshChange::MeshChange(const ActiveMesh& mesh) : number_(mesh.grid.particles()) {
  const std::size_t n = mesh.grid.particles();
  for (auto* list : {&particle_, &patch_at_, &node_was_}) list->reserve(n);
  for (auto* lists : {&first_edge_, &triple_at_}) {
    for (auto& list : *lists) list.reserve(n);
  }
  positions_.reserve(static_cast<int>(n));
  edges_.reserve(mesh.edges.capacity());
  triples_.reserve(mesh.triples.capacity());
  patches_.reserve(mesh.patches.capacity());
}

void MeshChange::begin(const ActiveMesh& mesh, const Field& x) {
  edges_.begin(mesh.edges);
  triples_.begin(mesh.triples);
  patches_.begin(mesh.patches);
  positions_ = x;
  particle_ = mesh.particle;
  for (int n = 0; n < mesh.nodes(); ++n) number_[particle_[n]] = n;
  for (auto* lists : {&first_edge_, &triple_at_}) {
    for (auto& list : *lists) list.assign(mesh.nodes(), kNew);
  }
  patch_at_.assign(mesh.nodes(), kNew);
  for (int e = static_cast<int>(mesh.edges.size()) - 1; e >= 0; --e) {
    first_edge_[mesh.edges[e].direction][mesh.edges[e].a] = e;
  }
  for (int t = 0; t < static_cast<int>(mesh.triples.size()); ++t) {
    triple_at_[mesh.triples[t].direction][mesh.triples[t].c] = t;
  }
  for (int k = 0; k < static_cast<int>(mesh.patches.size()); ++k) patch_at_[mesh.patches[k].nodes[0]] = k;
}

void MeshChange::end(const ActiveMesh& mesh, const Field& x) {
  followNodes(mesh, x);
  for (const Edge& edge : mesh.edges) edges_.add(find(edge));
  for (const Triple& triple : mesh.triples) triples_.add(find(triple));
  for (const Patch& patch : mesh.patches) patches_.add(find(patch));
}

void MeshChange::followNodes(const ActiveMesh& mesh, const Field& x) {
  const int count = static_cast<int>(particle_.size());
  node_was_.assign(mesh.nodes(), kNew);
  for (int n = 0; n < mesh.nodes(); ++n) {
    const int p = mesh.particle[n], then = number_[p];
    if (then < count && particle_[then] == p && positions_[then] == x[n]) node_was_[n] = then;
  }
}

/// Finds an edge. Edges from one node follow one another, one for each level.
int MeshChange::find(const Edge& edge) const {
  const int a = node_was_[edge.a], b = node_was_[edge.b], end = static_cast<int>(edges_.before.size());
  if (a == kNew || b == kNew || first_edge_[edge.direction][a] == kNew) return kNew;
  for (int e = first_edge_[edge.direction][a]; e < end && edges_.before[e].a == a; ++e) {
    if (edges_.before[e].b == b) return edges_.before[e].width == edge.width ? e : kNew;
  }
  return kNew;
}

int MeshChange::find(const Triple& triple) const {
  const int l = node_was_[triple.l], c = node_was_[triple.c], r = node_was_[triple.r];
  const int found = l == kNew || c == kNew || r == kNew ? kNew : triple_at_[triple.direction][c];
  if (found == kNew) return kNew;
  const Triple& then = triples_.before[found];
  const bool same = then.l == l && then.r == r && then.a == node_was_[triple.a] &&
                    then.b == node_was_[triple.b] && then.left == triple.left && then.right == triple.right &&
                    then.sagitta == triple.sagitta && then.area == triple.area;
  return same ? found : kNew;
}

int MeshChange::find(const Patch& patch) const {
  const int lower_left = node_was_[patch.nodes[0]];
  const int found = lower_left == kNew ? kNew : patch_at_[lower_left];
  if (found == kNew) return kNew;
  const bool same = std::equal(patch.nodes.begin(), patch.nodes.end(), patches_.before[found].nodes.begin(),
                               [this](int now, int then) { return node_was_[now] == then; });
  return same ? found : kNew;
}

}  // namespace haptic_cloth
