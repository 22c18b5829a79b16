// The part of InternalEnergy that deals with hysteresis.
#include <algorithm>
#include <cmath>

#include "energy/internal_energy.h"

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

void InternalEnergy::commit(int begin, int end, const Field& x) {
  const auto commit = [](const Loop& law, double s, Steps& steps, int place) {
    const Loop::Step step = steps.get(place);
    if (s > step.high || s < step.low) steps.set(place, law.next(step, s));
  };
  forEach(
      begin, end,
      [&](int e) {
        if (!edge_steps_.packs()) return;
        commit(stretch_[mesh_.edges[e].direction], strain(e, x), edge_steps_, gather_.edges().place(e));
      },
      [&](int t) {
        if (!triple_steps_.packs()) return;
        commit(bend_[mesh_.triples[t].direction], curvature(t, x), triple_steps_, gather_.triples().place(t));
      },
      [&](int k) {
        if (patch_steps_.packs()) commit(shear_, shearAngle(k, x), patch_steps_, k);
      });
}

void InternalEnergy::serialize(Archive& archive) {
  archive("edges", edge_steps_);
  archive("triples", triple_steps_);
  archive("patches", patch_steps_);
  archive("normals", node_normals_);
  archive("patch_normals", patch_normals_);
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
