// The part of InternalEnergy that deals with hysteresis.
#include <algorithm>
#include <cmath>

#include "energy/internal_energy.h"
#include "energy/shear.h"
#include "energy/twist.h"

namespace haptic_cloth {
namespace {

/// Only a step that reached a branch changes the play.
void commitPlay(const Loop& law, double s, Loop::Step& step) {
  if (s > step.high || s < step.low) step = law.begin(law.commit(step.play, s));
}

}  // namespace

template <class OnEdge, class OnTriple, class OnPatch>
void InternalEnergy::forEach(int begin, int end, OnEdge edge, OnTriple triple, OnPatch patch) const {
  const int triples = edge_count_, patches = triples + triple_count_;
  for (int k = begin; k < std::min(end, triples); ++k) edge(k);
  for (int k = std::max(begin, triples); k < std::min(end, patches); ++k) triple(k - triples);
  for (int k = std::max(begin, patches); k < end; ++k) patch(k - patches);
}

double InternalEnergy::shearAngle(int patch, const std::vector<Vec3>& x) const {
  return haptic_cloth::shearAngle(corners(patch, x));
}

void InternalEnergy::commit(int begin, int end, const std::vector<Vec3>& x) {
  forEach(
      begin, end,
      [&](int e) {
        if (edge_steps_.empty()) return;
        commitPlay(stretch_[mesh_.edges[e].direction], strain(e, x), edge_steps_[e]);
      },
      [&](int t) {
        if (triple_steps_.empty()) return;
        commitPlay(bend_[mesh_.triples[t].direction], curvature(t, x), triple_steps_[t]);
      },
      [&](int k) {
        if (!patch_steps_.empty()) commitPlay(shear_, shearAngle(k, x), patch_steps_[k]);
      });
}

InternalEnergy::Energy InternalEnergy::stored(const std::vector<Vec3>& x) const {
  Energy energy;
  const auto play = [](const std::vector<Loop::Step>& steps, int k) {
    return steps.empty() ? 0.0 : steps[k].play;
  };
  forEach(
      0, size(),
      [&](int e) {
        const Edge& edge = mesh_.edges[e];
        energy.stretch +=
            edge.length * edge.width * stretch_[edge.direction].stored(play(edge_steps_, e), strain(e, x));
      },
      [&](int t) {
        const Triple& triple = mesh_.triples[t];
        energy.bend += triple.area * bend_[triple.direction].stored(play(triple_steps_, t), curvature(t, x));
      },
      [&](int k) {
        const double area = mesh_.patches[k].area;
        if (!patch_normals_.empty()) {
          energy.bend += evaluateTwist(corners(k, x), patch_normals_[k], twist_rigidity_, area).energy;
        }
        energy.shear += area * shear_.stored(play(patch_steps_, k), shearAngle(k, x));
      });
  return energy;
}

void InternalEnergy::remember(const std::vector<Vec3>& x, ForceHistory& history) const {
  if (!hasMemory()) return;
  if (!edge_steps_.empty()) {
    for (const Patch& patch : mesh_.patches) {
      for (int side = 0; side < 4; ++side) {
        const int e = patch.sides[side];
        history.sides(patch.cell)[side] =
            stretch_[mesh_.edges[e].direction].force(edge_steps_[e].play, strain(e, x));
      }
    }
  }
  for (int t = 0; t < static_cast<int>(triple_steps_.size()); ++t) {
    const Triple& triple = mesh_.triples[t];
    const double force = bend_[triple.direction].force(triple_steps_[t].play, curvature(t, x));
    history.moment(mesh_.particle[triple.c], triple.direction) = force;
  }
  for (int k = 0; k < static_cast<int>(patch_steps_.size()); ++k) {
    history.shear(mesh_.patches[k].cell) = shear_.force(patch_steps_[k].play, shearAngle(k, x));
  }
}

/// An edge takes the mean tension of the one or two cells it is a side of.
void InternalEnergy::recallEdges(const std::vector<Vec3>& x, ForceHistory& history) {
  if (edge_steps_.empty()) return;
  for (Loop::Step& step : edge_steps_)
    step.play = 0.0;  // sums tension times half width until it is set below
  for (const Patch& patch : mesh_.patches) {
    const double span = patch.cell.span();
    for (int side = 0; side < 4; ++side) {
      const double half_width = 0.5 * span * (side < 2 ? mesh_.grid.dy : mesh_.grid.dx);
      edge_steps_[patch.sides[side]].play += half_width * history.sides(patch.cell)[side];
    }
  }
  for (int e = 0; e < static_cast<int>(edge_steps_.size()); ++e) {
    const Edge& edge = mesh_.edges[e];
    const Loop& law = stretch_[edge.direction];
    edge_steps_[e] = law.begin(law.playFor(edge_steps_[e].play / edge.width, strain(e, x)));
  }
}

void InternalEnergy::recall(const std::vector<Vec3>& x, ForceHistory& history) {
  recallEdges(x, history);
  for (int t = 0; t < static_cast<int>(triple_steps_.size()); ++t) {
    const Triple& triple = mesh_.triples[t];
    const Loop& law = bend_[triple.direction];
    const double force = history.moment(mesh_.particle[triple.c], triple.direction);
    triple_steps_[t] = law.begin(law.playFor(force, curvature(t, x)));
  }
  for (int k = 0; k < static_cast<int>(patch_steps_.size()); ++k) {
    patch_steps_[k] = shear_.begin(shear_.playFor(history.shear(mesh_.patches[k].cell), shearAngle(k, x)));
  }
}

}  // namespace haptic_cloth
