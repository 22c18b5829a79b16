#include "energy/bend_energy.h"

#include <algorithm>

#include "simd/kernels.h"

namespace haptic_cloth {

BendEnergy::BendEnergy(const std::array<Loop, 2>& laws, const ActiveMesh& mesh)
    : ElementEnergy(mesh, mesh.triples, {laws.begin(), laws.end()}) {
  sagittas_.reserve(packs_.capacity());
  held_.reserve(mesh.triples.capacity());
  folds_.reserve(mesh.triples.capacity());
}

void BendEnergy::holdFolds(const Surface& at) {
  held_.assign(elements(), 0.0);
  if (isZero()) return;  // without elements
  for (const int t : at.normals.sharpFolds()) {
    const double bent = deformation(t, at), moment = loop(t).force(step(t).play, bent);
    held_[t] = bent * moment > 0.0 ? area(t) * moment / bent : 0.0;
  }
  listFolds();
}

void BendEnergy::listFolds() {
  folds_.clear();
  for (int t = 0; t < elements(); ++t) {
    if (held_[t] > 0.0) folds_.push_back(t);
  }
  std::sort(folds_.begin(), folds_.end(),
            [this](int a, int b) { return places_.place(a) < places_.place(b); });
}

/// Calls visit(triple) for the sharp folds in packs begin..end.
template <class Visit>
void BendEnergy::forFolds(int begin, int end, const Visit& visit) const {
  const auto before = [this](int triple, int place) { return places_.place(triple) < place; };
  auto fold = std::lower_bound(folds_.begin(), folds_.end(), kPack * begin, before);
  for (; fold != folds_.end() && places_.place(*fold) < kPack * end; ++fold) visit(*fold);
}

void BendEnergy::resize(const PackedRange& places) {
  startPacks(places);
  sagittas_.clear();
  for (int t = 0; t < elements(); ++t) {
    const Triple& triple = list_[t];
    const int place = places_.place(t), l = place % kPack;
    TriplePack& pack = packs_[place / kPack];
    pack.l.index[l] = triple.l;
    pack.c.index[l] = triple.c;
    pack.r.index[l] = triple.r;
    pack.left[l] = triple.left;
    pack.right[l] = triple.right;
    pack.area[l] = triple.area;
    if (triple.sagitta == 0.0) continue;
    if (pack.sagitta < 0) {
      pack.sagitta = static_cast<int>(sagittas_.size());
      sagittas_.emplace_back();
    }
    SagittaPack& beside = sagittas_[pack.sagitta];
    beside.a.index[l] = triple.a;
    beside.b.index[l] = triple.b;
    beside.coefficient[l] = triple.sagitta;
  }
  for (TriplePack& pack : packs_) {
    for (PackIndices* nodes : {&pack.l, &pack.c, &pack.r}) nodes->finish();
  }
  for (SagittaPack& pack : sagittas_) {
    for (PackIndices* nodes : {&pack.a, &pack.b}) nodes->finish();
  }
}

void BendEnergy::evaluate(const PackRun& run, const Surface& at, const MutableArrays& slots,
                          ElasticEnergy& sum) {
  sum.bend += kernels().evaluateTriples(packs_.data(), sagittas_.data(), run.begin, run.end,
                                        tables_[run.direction].view(), memory_.packs(), at.x.arrays(),
                                        at.normals.nodes(), slots, run.slot);
  forFolds(run.begin, run.end, [&](int t) {
    const Vec3 turned = across(t, list_[t].bent(at.x), at.normals);
    sum.bend += 0.5 * held_[t] * turned.squaredNorm();
    const int slot = run.slot + places_.place(t) - kPack * run.begin;
    slots.x[slot] += held_[t] * turned.x();
    slots.y[slot] += held_[t] * turned.y();
    slots.z[slot] += held_[t] * turned.z();
  });
}

void BendEnergy::addQuadraticForm(const PackRun& run, const Field& d, const SurfaceNormals& normals,
                                  double& sum) const {
  sum += kernels().tripleQuadraticForm(packs_.data(), sagittas_.data(), run.begin, run.end, d.arrays(),
                                       normals.nodes());
  forFolds(run.begin, run.end,
           [&](int t) { sum += held_[t] * across(t, list_[t].bent(d), normals).squaredNorm(); });
}

void BendEnergy::addBlocks(int begin, int end, const SurfaceNormals& normals, BlockField& blocks) const {
  kernels().addTripleBlocks(packs_.data(), sagittas_.data(), begin, end, normals.nodes(), blocks.arrays());
  forFolds(begin, end, [&](int t) {
    const Block block = held_[t] * (isotropic(1.0) - square(normals.node(list_[t].c)));
    for (const auto& [node, coefficient] : list_[t].parts())
      blocks.set(node, blocks[node] + coefficient * coefficient * block);
  });
}

void BendEnergy::remember(const Surface& at, ForceHistory& history) const {
  history.clearBending();
  for (int t = 0; memory_.packs() && t < elements(); ++t) {
    const Triple& triple = list_[t];
    const int particle = mesh_.particle[triple.c];
    const double bent = deformation(t, at);
    history.moment(particle, triple.direction) = loop(t).force(step(t).play, bent);
    history.curvature(particle, triple.direction) = bent;
  }
  // A hanging node has no triple, but a merge beside it may need its moment.
  for (const Ghost& ghost : mesh_.ghosts) {
    const int node = mesh_.particle[ghost.node], a = mesh_.particle[ghost.a], b = mesh_.particle[ghost.b];
    for (const int d : {kWarp, kWeft}) {
      history.moment(node, d) = 0.5 * (history.moment(a, d) + history.moment(b, d));
      history.curvature(node, d) = 0.5 * (history.curvature(a, d) + history.curvature(b, d));
    }
  }
}

void BendEnergy::recall(const Followed<Triple>& change, ForceHistory& history) {
  for (int t = 0; memory_.packs() && t < elements(); ++t) {
    if (!change.isNew(t)) continue;
    const int particle = mesh_.particle[list_[t].c], direction = list_[t].direction;
    setPlay(t, loop(t).playFor(history.moment(particle, direction), history.curvature(particle, direction)));
  }
}

void BendEnergy::deformations(int pack, const Surface& at, double* values) const {
  kernels().tripleCurvatures(packs_.data(), sagittas_.data(), pack, pack + 1, at.x.arrays(),
                             at.normals.nodes(), values);
}

void BendEnergy::addTurned(const Surface& at, ElasticEnergy& sum) const {
  for (const int t : folds_)
    sum.bend += 0.5 * held_[t] * across(t, list_[t].bent(at.x), at.normals).squaredNorm();
}

void BendEnergy::serialize(Archive& archive) {
  ElementEnergy::serialize(archive);
  archive("held", held_);
  listFolds();
}

bool BendEnergy::touches(const TriplePack& pack, const char* flags) const {
  if (pack.l.anyOf(flags) || pack.c.anyOf(flags) || pack.r.anyOf(flags)) return true;
  if (pack.sagitta < 0) return false;
  return sagittas_[pack.sagitta].a.anyOf(flags) || sagittas_[pack.sagitta].b.anyOf(flags);
}

void BendEnergy::addEnergy(const Triple& triple, int /*k*/, const Loop& law, double play, const Surface& at,
                           ElasticEnergy& sum) const {
  sum.bend += triple.area * law.stored(play, curvature(triple, at));
}

}  // namespace haptic_cloth
