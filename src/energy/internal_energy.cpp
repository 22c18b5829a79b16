#include "energy/internal_energy.h"

#include <algorithm>
#include <cmath>

#include "energy/shear.h"
#include "energy/twist.h"
#include "simd/kernels.h"

namespace haptic_cloth {
namespace {

std::array<LawTable, 2> tables(const std::array<Loop, 2>& laws) {
  return {LawTable(laws[kWarp]), LawTable(laws[kWeft])};
}

}  // namespace

InternalEnergy::InternalEnergy(const Fabric& fabric, const ActiveMesh& mesh)
    : mesh_(mesh),
      stretch_(fabric.tensile),
      bend_(fabric.bending),
      shear_(fabric.shear),
      stretch_tables_(tables(stretch_)),
      bend_tables_(tables(bend_)),
      shear_table_(shear_),
      twist_rigidity_(fabric.twist_rigidity),
      bends_(!bend_[kWarp].isZero() || !bend_[kWeft].isZero()),
      shears_(!shear_.isZero() || twist_rigidity_ > 0.0),
      gather_(mesh, {bends_, !shear_.isZero(), twist_rigidity_ > 0.0}),
      change_(mesh) {
  const int edges = static_cast<int>(mesh.edges.capacity()),
            triples = static_cast<int>(mesh.triples.capacity()),
            patches = static_cast<int>(mesh.patches.capacity());
  for (Field* normals : {&node_normals_, &before_.normals}) normals->reserve(mesh.grid.particles());
  slots_.reserve(NodeGather::capacity(mesh));
  patch_normals_.reserve(patches);
  if (twist_rigidity_ > 0.0) before_.patch_normals.reserve(patches);
  edge_packs_.reserve(edges / kPack + 2);
  triple_packs_.reserve(triples / kPack + 2);
  patch_packs_.reserve(patches / kPack + 1);
  if (hasMemory(stretch_)) {
    for (Steps* steps : {&edge_steps_, &before_.edges}) steps->reserve(edges);
    edge_loads_.reserve(edges);
  }
  for (Steps* steps : {&triple_steps_, &before_.triples}) {
    if (hasMemory(bend_)) steps->reserve(triples);
  }
  for (Steps* steps : {&patch_steps_, &before_.patches}) {
    if (shear_.hasMemory()) steps->reserve(patches);
  }
  resize();
  forgetAll();
}

void InternalEnergy::resize() {
  gather_.rebuild(mesh_);
  edge_count_ = static_cast<int>(mesh_.edges.size());
  triple_count_ = bends_ ? static_cast<int>(mesh_.triples.size()) : 0;
  patch_count_ = shears_ ? static_cast<int>(mesh_.patches.size()) : 0;
  slots_.clear(gather_.slots());
  if (hasMemory(stretch_)) edge_steps_.resize(gather_.edges().size());
  if (hasMemory(bend_)) triple_steps_.resize(gather_.triples().size());
  if (shear_.hasMemory()) patch_steps_.resize(gather_.patches().size());
  packEdges();
  packTriples();
  packPatches();
}

void InternalEnergy::packEdges() {
  edge_packs_.assign(gather_.edges().size() / kPack, EdgePack{});
  for (int e = 0; e < edge_count_; ++e) {
    const Edge& edge = mesh_.edges[e];
    const int place = gather_.edges().place(e), l = place % kPack;
    EdgePack& pack = edge_packs_[place / kPack];
    pack.a.index[l] = edge.a;
    pack.b.index[l] = edge.b;
    pack.inverse_length[l] = 1.0 / edge.length;
    pack.area[l] = edge.length * edge.width;
  }
  for (EdgePack& pack : edge_packs_) {
    pack.a.finish();
    pack.b.finish();
  }
}

void InternalEnergy::packTriples() {
  triple_packs_.assign(gather_.triples().size() / kPack, TriplePack{});
  for (int t = 0; t < triple_count_; ++t) {
    const Triple& triple = mesh_.triples[t];
    const int place = gather_.triples().place(t), l = place % kPack;
    TriplePack& pack = triple_packs_[place / kPack];
    pack.l.index[l] = triple.l;
    pack.c.index[l] = triple.c;
    pack.r.index[l] = triple.r;
    pack.left[l] = triple.left;
    pack.right[l] = triple.right;
    pack.area[l] = triple.area;
  }
  for (TriplePack& pack : triple_packs_) {
    for (PackIndices* nodes : {&pack.l, &pack.c, &pack.r}) nodes->finish();
  }
}

void InternalEnergy::packPatches() {
  patch_packs_.assign(gather_.patches().size() / kPack, PatchPack{});
  for (int p = 0; p < static_cast<int>(patch_packs_.size()); ++p)
    patch_packs_[p].corners = mesh_.patch_corners[p];
  for (int k = 0; k < patch_count_; ++k) patch_packs_[k / kPack].area[k % kPack] = mesh_.patches[k].area;
}

/// Sets the normals. A node's normal is the mean of those of its cells, weighted by area.
void InternalEnergy::setNormals(const Field& positions) {
  const int patches = static_cast<int>(mesh_.patches.size());
  patch_normals_.resize(patches);
  kernels().patchNormals(mesh_.patch_corners.data(), static_cast<int>(mesh_.patch_corners.size()),
                         positions.arrays(), patch_normals_.arrays());
  node_normals_.clear(mesh_.nodes());
  for (int c = 0; c < 3; ++c) {
    const auto& of_patch = patch_normals_.coordinate(c);
    auto& of_node = node_normals_.coordinate(c);
    for (int k = 0; k < patches; ++k) {
      for (const int corner : mesh_.patches[k].nodes) of_node[corner] += of_patch[k];
    }
  }
  kernels().normalise(mesh_.nodes(), node_normals_.arrays());
  if (twist_rigidity_ > 0.0) kernels().normalise(patches, patch_normals_.arrays());
}

void InternalEnergy::appendAwake(const std::vector<char>& awake, Runs& runs) const {
  const auto touches = [&](const PackIndices& nodes) {
    return std::any_of(nodes.index, nodes.index + kPack, [&](int node) { return awake[node] != 0; });
  };
  int first = 0;
  const auto append = [&](bool wanted) {
    if (wanted) runs.add(first, first + kPack);
    first += kPack;
  };
  for (const EdgePack& pack : edge_packs_) append(touches(pack.a) || touches(pack.b));
  for (const TriplePack& pack : triple_packs_) append(touches(pack.l) || touches(pack.c) || touches(pack.r));
  for (const PatchPack& pack : patch_packs_) {
    append(std::any_of(std::begin(pack.corners.at), std::end(pack.corners.at), touches));
  }
}

InternalEnergy::Parts InternalEnergy::split(int begin, int end) const {
  int first = 0;
  const auto next = [&](int places) {
    const std::pair<int, int> part{(std::clamp(begin - first, 0, places)) / kPack,
                                   (std::clamp(end - first, 0, places)) / kPack};
    first += places;
    return part;
  };
  const auto both = [&](const PackedRange& range) {
    const auto warp = next(range.warpEnd());
    return std::array<std::pair<int, int>, 2>{warp, next(range.size() - range.warpEnd())};
  };
  const auto edges = both(gather_.edges());
  const auto triples = both(gather_.triples());
  return {edges, triples, next(gather_.patches().size())};
}

InternalEnergy::Energy InternalEnergy::evaluate(int begin, int end, const Field& x) {
  const Parts parts = split(begin, end);
  const ConstArrays at = x.arrays(), normals = node_normals_.arrays();
  const MutableArrays slots = slots_.arrays();
  const auto from = [](const Steps& steps, int pack) {
    return steps.packs() ? steps.packs() + pack : nullptr;
  };
  Energy energy;
  for (const int direction : {kWarp, kWeft}) {
    const int edges = direction * gather_.edges().warpEnd() / kPack;
    const auto [e0, e1] = parts.edges[direction];
    if (e0 < e1) {
      energy.stretch +=
          kernels().evaluateEdges(edge_packs_.data() + edges, e0, e1, stretch_tables_[direction].view(),
                                  from(edge_steps_, edges), at, slots, kPack * (edges + e0));
    }
    const int triples = direction * gather_.triples().warpEnd() / kPack;
    const auto [t0, t1] = parts.triples[direction];
    if (t0 < t1) {
      energy.bend += kernels().evaluateTriples(
          triple_packs_.data() + triples, t0, t1, bend_tables_[direction].view(),
          from(triple_steps_, triples), at, normals, slots, gather_.firstTriple() + kPack * (triples + t0));
    }
  }
  const auto [p0, p1] = parts.patches;
  if (p0 < p1 && !shear_.isZero()) {
    energy.shear =
        kernels().evaluateShears(patch_packs_.data(), p0, p1, shear_table_.view(), patch_steps_.packs(), at,
                                 slots, gather_.firstPatch() + kPack * p0, gather_.patches().size());
  }
  if (p0 < p1 && twist_rigidity_ > 0.0) {  // counts as bending
    energy.bend +=
        kernels().evaluateTwists(patch_packs_.data(), p0, p1, twist_rigidity_, at, patch_normals_.arrays(),
                                 slots, gather_.firstTwist() + kPack * p0);
  }
  return energy;
}

double InternalEnergy::curvature(int begin, int end, const Field& d) const {
  const Parts parts = split(begin, end);
  const ConstArrays along = d.arrays(), normals = node_normals_.arrays();
  double sum = 0.0;
  for (const int direction : {kWarp, kWeft}) {
    const auto [e0, e1] = parts.edges[direction];
    const int edges = direction * gather_.edges().warpEnd() / kPack;
    sum += kernels().edgeCurvature(edge_packs_.data() + edges, e0, e1, along);
    const auto [t0, t1] = parts.triples[direction];
    const int triples = direction * gather_.triples().warpEnd() / kPack;
    sum += kernels().tripleCurvature(triple_packs_.data() + triples, t0, t1, along, normals);
  }
  const auto [p0, p1] = parts.patches;
  if (!shear_.isZero()) sum += kernels().shearCurvature(patch_packs_.data(), p0, p1, along);
  if (twist_rigidity_ > 0.0) {
    sum += kernels().twistCurvature(patch_packs_.data(), p0, p1, twist_rigidity_, along,
                                    patch_normals_.arrays());
  }
  return sum;
}

void InternalEnergy::addBlocks(int part, int parts, BlockField& blocks) const {
  const ConstArrays normals = node_normals_.arrays();
  const BlockArrays to = blocks.arrays();
  const auto share = [&](const auto& packs, const auto& add) {
    const long count = static_cast<long>(packs.size());
    add(packs.data(), static_cast<int>(count * part / parts), static_cast<int>(count * (part + 1) / parts));
  };
  share(edge_packs_,
        [&](const EdgePack* p, int begin, int end) { kernels().addEdgeBlocks(p, begin, end, to); });
  share(triple_packs_, [&](const TriplePack* p, int begin, int end) {
    kernels().addTripleBlocks(p, begin, end, normals, to);
  });
  share(patch_packs_, [&](const PatchPack* p, int begin, int end) {
    if (!shear_.isZero()) kernels().addShearBlocks(p, begin, end, to);
    if (twist_rigidity_ > 0.0) {
      kernels().addTwistBlocks(p, begin, end, twist_rigidity_, patch_normals_.arrays(), to);
    }
  });
}

}  // namespace haptic_cloth
