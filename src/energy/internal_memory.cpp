// Part of InternalEnergy that handles hysteresis.
#include <algorithm>
#include <cmath>

#include "energy/internal_energy.h"
#include "simd/kernels.h"

namespace haptic_cloth {

template <class OnEdge, class OnTriple, class OnPatch>
void InternalEnergy::forEach(int begin, int end, OnEdge edge, OnTriple triple, OnPatch patch) const {
  const int triples = edge_count_, patches = triples + triple_count_;
  for (int k = begin; k < std::min(end, triples); ++k) edge(k);
  for (int k = std::max(begin, triples); k < std::min(end, patches); ++k) triple(k - triples);
  for (int k = std::max(begin, patches); k < end; ++k) patch(k - patches);
}

void InternalEnergy::forgetAll() {
  const auto fresh = [](const Loop& law) { return law.begin(law.initialPlay()); };
  if (edge_steps_.packs()) {
    for (int e = 0; e < edge_count_; ++e) {
      edge_steps_.set(gather_.edges().place(e), fresh(stretch_[mesh_.edges[e].direction]));
    }
  }
  if (triple_steps_.packs()) {
    for (int t = 0; t < triple_count_; ++t) {
      triple_steps_.set(gather_.triples().place(t), fresh(bend_[mesh_.triples[t].direction]));
    }
  }
  if (patch_steps_.packs()) {
    for (int k = 0; k < patch_count_; ++k) patch_steps_.set(k, fresh(shear_));
  }
}

namespace {

/// Commits the elements of a pack that left their path. An element at rest stands at the end of its
/// path and may leave it by a rounding error, which is ignored.
/// @param areas areas of the elements, zero if there is no element
void commitPack(const Loop& law, const double* deformations, const double* areas, StepPack& pack) {
  constexpr double kRounding = 1e-12;  // relative to the length of the path
  for (int l = 0; l < kPack; ++l) {
    const double s = deformations[l], slack = kRounding * (pack.high[l] - pack.low[l]);
    const bool left = s > pack.high[l] + slack || s < pack.low[l] - slack;
    if (left && areas[l] > 0.0) pack.set(l, law.next(pack.get(l), s));
  }
}

}  // namespace

void InternalEnergy::commit(int begin, int end, const Field& x) {
  const Parts parts = split(begin, end);
  const ConstArrays at = x.arrays(), normals = node_normals_.arrays();
  double deformations[kPack];
  for (const int direction : {kWarp, kWeft}) {
    const auto [e0, e1] = parts.edges[direction];
    const int edges = direction * gather_.edges().warpEnd() / kPack;
    for (int p = edges + e0; edge_steps_.packs() && p < edges + e1; ++p) {
      kernels().edgeStrains(edge_packs_.data(), p, p + 1, at, deformations);
      commitPack(stretch_[direction], deformations, edge_packs_[p].area, edge_steps_.pack(p));
    }
    const auto [t0, t1] = parts.triples[direction];
    const int triples = direction * gather_.triples().warpEnd() / kPack;
    for (int p = triples + t0; triple_steps_.packs() && p < triples + t1; ++p) {
      kernels().tripleCurvatures(triple_packs_.data(), p, p + 1, at, normals, deformations);
      commitPack(bend_[direction], deformations, triple_packs_[p].area, triple_steps_.pack(p));
    }
  }
  for (int p = parts.patches.first; patch_steps_.packs() && p < parts.patches.second; ++p) {
    kernels().shearAngles(patch_packs_.data(), p, p + 1, at, deformations);
    commitPack(shear_, deformations, patch_packs_[p].area, patch_steps_.pack(p));
  }
}

void InternalEnergy::serialize(Archive& archive) {
  archive("edges", edge_steps_);
  archive("triples", triple_steps_);
  archive("patches", patch_steps_);
  archive("normals", node_normals_);
  if (twist_rigidity_ > 0.0) archive("patch_normals", patch_normals_);
}

void InternalEnergy::Steps::serialize(Archive& archive) {
  constexpr std::size_t kDoubles = sizeof(StepPack) / sizeof(double);
  archive.doubles("memory", packs_.empty() ? nullptr : packs_.front().play, kDoubles * packs_.size());
}

InternalEnergy::Energy InternalEnergy::stored(const Field& x) const {
  Energy energy;
  forEach(
      0, elements(), [&](int e) { energy.stretch += stored(mesh_.edges[e], edgeStep(e).play, x); },
      [&](int t) {
        const Triple& triple = mesh_.triples[t];
        energy.bend += stored(triple, tripleStep(t).play, normal(triple.c), x);
      },
      [&](int k) {
        const Energy patch = stored(mesh_.patches[k], patchStep(k).play, twistAxis(patch_normals_, k), x);
        energy.bend += patch.bend;
        energy.shear += patch.shear;
      });
  return energy;
}

}  // namespace haptic_cloth
