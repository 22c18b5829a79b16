// The part of InternalEnergy that deals with hysteresis.
#include <algorithm>
#include <cmath>

#include "energy/internal_energy.h"
#include "energy/shear.h"
#include "energy/twist.h"

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
  constexpr std::size_t kDoubles = sizeof(StepLanes) / sizeof(double);
  archive.doubles("memory", packs_.empty() ? nullptr : packs_.front().play, kDoubles * packs_.size());
}

InternalEnergy::Energy InternalEnergy::stored(const Field& x) const {
  Energy energy;
  forEach(
      0, elements(),
      [&](int e) {
        const Edge& edge = mesh_.edges[e];
        energy.stretch +=
            edge.length * edge.width * stretch_[edge.direction].stored(edgeStep(e).play, strain(e, x));
      },
      [&](int t) {
        const Triple& triple = mesh_.triples[t];
        energy.bend += triple.area * bend_[triple.direction].stored(tripleStep(t).play, curvature(t, x));
      },
      [&](int k) {
        const double area = mesh_.patches[k].area;
        if (twist_rigidity_ > 0.0) {
          energy.bend += evaluateTwist(corners(k, x), patchNormal(k), twist_rigidity_, area).energy;
        }
        energy.shear += area * shear_.stored(patchStep(k).play, shearAngle(k, x));
      });
  return energy;
}

void InternalEnergy::remember(const Field& x, ForceHistory& history) const {
  if (!hasMemory()) return;
  if (edge_steps_.packs()) {
    for (const Patch& patch : mesh_.patches) {
      for (int side = 0; side < 4; ++side) {
        const int e = patch.sides[side];
        history.sides(patch.cell)[side] =
            stretch_[mesh_.edges[e].direction].force(edgeStep(e).play, strain(e, x));
      }
    }
  }
  history.clearBending();
  for (int t = 0; triple_steps_.packs() && t < triple_count_; ++t) {
    const Triple& triple = mesh_.triples[t];
    const int particle = mesh_.particle[triple.c];
    const double bent = curvature(t, x);
    history.moment(particle, triple.direction) = bend_[triple.direction].force(tripleStep(t).play, bent);
    history.curvature(particle, triple.direction) = bent;
  }
  // A hanging node has no triple of its own, but a merge beside it may ask for what it held.
  for (const Ghost& ghost : mesh_.ghosts) {
    const int at = mesh_.particle[ghost.node], a = mesh_.particle[ghost.a], b = mesh_.particle[ghost.b];
    for (const int d : {kWarp, kWeft}) {
      history.moment(at, d) = 0.5 * (history.moment(a, d) + history.moment(b, d));
      history.curvature(at, d) = 0.5 * (history.curvature(a, d) + history.curvature(b, d));
    }
  }
  for (int k = 0; patch_steps_.packs() && k < patch_count_; ++k) {
    history.shear(mesh_.patches[k].cell) = shear_.force(patchStep(k).play, shearAngle(k, x));
  }
}

/// An edge takes the mean tension of the one or two cells it is a side of.
void InternalEnergy::recallEdges(const Field& x, ForceHistory& history) {
  if (!edge_steps_.packs()) return;
  edge_loads_.assign(edge_count_, 0.0);
  for (const Patch& patch : mesh_.patches) {
    const double span = patch.cell.span();
    for (int side = 0; side < 4; ++side) {
      const double half_width = 0.5 * span * (side < 2 ? mesh_.grid.dy : mesh_.grid.dx);
      edge_loads_[patch.sides[side]] += half_width * history.sides(patch.cell)[side];
    }
  }
  for (int e = 0; e < edge_count_; ++e) {
    const Edge& edge = mesh_.edges[e];
    const Loop& law = stretch_[edge.direction];
    const double play = law.playFor(edge_loads_[e] / edge.width, strain(e, x));
    edge_steps_.set(gather_.edges().place(e), law.begin(play));
  }
}

void InternalEnergy::recall(const Field& x, ForceHistory& history) {
  recallEdges(x, history);
  for (int t = 0; triple_steps_.packs() && t < triple_count_; ++t) {
    const Triple& triple = mesh_.triples[t];
    const Loop& law = bend_[triple.direction];
    const int particle = mesh_.particle[triple.c];
    const double play = law.playFor(history.moment(particle, triple.direction),
                                    history.curvature(particle, triple.direction));
    triple_steps_.set(gather_.triples().place(t), law.begin(play));
  }
  for (int k = 0; patch_steps_.packs() && k < patch_count_; ++k) {
    const double force = history.shear(mesh_.patches[k].cell);
    patch_steps_.set(k, shear_.begin(shear_.playFor(force, shearAngle(k, x))));
  }
}

}  // namespace haptic_cloth
