// Part of InternalEnergy that handles changes of the mesh.
#include "energy/internal_energy.h"

namespace haptic_cloth {
namespace {

template <class Element, class Visit>
void forNew(const Followed<Element>& elements, const Visit& visit) {
  for (int k = 0; k < static_cast<int>(elements.was.size()); ++k) {
    if (elements.isNew(k)) visit(k);
  }
}

template <class Element, class Visit>
void forGone(const Followed<Element>& elements, const Visit& visit) {
  for (int k = 0; k < static_cast<int>(elements.before.size()); ++k) {
    if (!elements.stays[k]) visit(k, elements.before[k]);
  }
}

}  // namespace

void InternalEnergy::beginChange(const Field& x) {
  change_.begin(mesh_, x);
  before_.edge_places = gather_.edges();
  before_.triple_places = gather_.triples();
  before_.edges = edge_steps_;
  before_.triples = triple_steps_;
  before_.patches = patch_steps_;
  before_.normals = node_normals_;
  if (twist_rigidity_ > 0.0) before_.patch_normals = patch_normals_;
}

void InternalEnergy::endChange(const Field& x) {
  change_.end(mesh_, x);
  for (int e = 0; edge_steps_.packs() && e < edge_count_; ++e) {
    if (change_.edges().isNew(e)) continue;
    const int was = before_.edge_places.place(change_.edges().was[e]);
    edge_steps_.set(gather_.edges().place(e), before_.edges.get(was));
  }
  for (int t = 0; triple_steps_.packs() && t < triple_count_; ++t) {
    if (change_.triples().isNew(t)) continue;
    const int was = before_.triple_places.place(change_.triples().was[t]);
    triple_steps_.set(gather_.triples().place(t), before_.triples.get(was));
  }
  for (int k = 0; patch_steps_.packs() && k < patch_count_; ++k) {
    if (!change_.patches().isNew(k)) patch_steps_.set(k, before_.patches.get(change_.patches().was[k]));
  }
}

double InternalEnergy::madeByChange(const Field& x) const {
  const Field& from = change_.positions();
  double made = 0.0;
  const auto both = [](const Energy& patch) { return patch.bend + patch.shear; };
  forNew(change_.edges(), [&](int e) { made += stored(mesh_.edges[e], edgeStep(e).play, x); });
  forGone(change_.edges(), [&](int e, const Edge& edge) {
    made -= stored(edge, before_.edges.get(before_.edge_places.place(e)).play, from);
  });
  forNew(change_.triples(), [&](int t) {
    const Triple& triple = mesh_.triples[t];
    made += stored(triple, tripleStep(t).play, normal(triple.c), x);
  });
  forGone(change_.triples(), [&](int t, const Triple& triple) {
    const double play = before_.triples.get(before_.triple_places.place(t)).play;
    made -= stored(triple, play, before_.normals[triple.c], from);
  });
  forNew(change_.patches(), [&](int k) {
    made += both(stored(mesh_.patches[k], patchStep(k).play, twistAxis(patch_normals_, k), x));
  });
  forGone(change_.patches(), [&](int k, const Patch& patch) {
    made -= both(stored(patch, before_.patches.get(k).play, twistAxis(before_.patch_normals, k), from));
  });
  return made;
}

void InternalEnergy::remember(const Field& x, ForceHistory& history) const {
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
  // A hanging node has no triple, but a merge beside it may need its moment.
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

/// Sets the memory of new edges. An edge takes the mean tension of the one or two cells beside it.
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
    if (!change_.edges().isNew(e)) continue;
    const Edge& edge = mesh_.edges[e];
    const Loop& law = stretch_[edge.direction];
    const double play = law.playFor(edge_loads_[e] / edge.width, strain(e, x));
    edge_steps_.set(gather_.edges().place(e), law.begin(play));
  }
}

void InternalEnergy::recall(const Field& x, ForceHistory& history) {
  recallEdges(x, history);
  for (int t = 0; triple_steps_.packs() && t < triple_count_; ++t) {
    if (!change_.triples().isNew(t)) continue;
    const Triple& triple = mesh_.triples[t];
    const Loop& law = bend_[triple.direction];
    const int particle = mesh_.particle[triple.c];
    const double play = law.playFor(history.moment(particle, triple.direction),
                                    history.curvature(particle, triple.direction));
    triple_steps_.set(gather_.triples().place(t), law.begin(play));
  }
  for (int k = 0; patch_steps_.packs() && k < patch_count_; ++k) {
    if (!change_.patches().isNew(k)) continue;
    const double force = history.shear(mesh_.patches[k].cell);
    patch_steps_.set(k, shear_.begin(shear_.playFor(force, shearAngle(k, x))));
  }
}

}  // namespace haptic_cloth
