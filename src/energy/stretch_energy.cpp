#include "energy/stretch_energy.h"

#include "simd/kernels.h"

namespace haptic_cloth {

StretchEnergy::StretchEnergy(const std::array<Loop, 2>& laws, const ActiveMesh& mesh)
    : ElementEnergy(mesh, mesh.edges, {laws.begin(), laws.end()}) {
  if (hasMemory()) loads_.reserve(mesh.edges.capacity());
}

void StretchEnergy::resize(const PackedRange& places) {
  startPacks(places);
  for (int e = 0; e < elements(); ++e) {
    const Edge& edge = list_[e];
    const int place = places_.place(e), l = place % kPack;
    EdgePack& pack = packs_[place / kPack];
    pack.a.index[l] = edge.a;
    pack.b.index[l] = edge.b;
    pack.inverse_length[l] = 1.0 / edge.length;
    pack.area[l] = area(e);
  }
  for (EdgePack& pack : packs_) {
    pack.a.finish();
    pack.b.finish();
  }
}

void StretchEnergy::evaluate(const PackRun& run, const Surface& at, const MutableArrays& slots,
                             ElasticEnergy& sum) {
  sum.stretch += kernels().evaluateEdges(packs_.data(), run.begin, run.end, tables_[run.direction].view(),
                                         memory_.packs(), at.x.arrays(), slots, run.slot);
}

void StretchEnergy::addQuadraticForm(const PackRun& run, const Field& d, const SurfaceNormals& /*normals*/,
                                     double& sum) const {
  sum += kernels().edgeQuadraticForm(packs_.data(), run.begin, run.end, d.arrays());
}

void StretchEnergy::addBlocks(int begin, int end, const SurfaceNormals& /*normals*/,
                              BlockField& blocks) const {
  kernels().addEdgeBlocks(packs_.data(), begin, end, blocks.arrays());
}

void StretchEnergy::remember(const Surface& at, ForceHistory& history) const {
  if (!memory_.packs()) return;
  for (const Patch& patch : mesh_.patches) {
    for (int side = 0; side < 4; ++side) {
      const int e = patch.sides[side];
      history.sides(patch.cell)[side] = loop(e).force(step(e).play, deformation(e, at));
    }
  }
}

/// Sets the memory of new edges. An edge takes the mean tension of the one or two cells beside it.
void StretchEnergy::recall(const Followed<Edge>& change, const Surface& at, ForceHistory& history) {
  if (!memory_.packs()) return;
  loads_.assign(elements(), 0.0);
  for (const Patch& patch : mesh_.patches) {
    const double span = patch.cell.span();
    for (int side = 0; side < 4; ++side) {
      const double half_width = 0.5 * span * (side < 2 ? mesh_.grid.dy : mesh_.grid.dx);
      loads_[patch.sides[side]] += half_width * history.sides(patch.cell)[side];
    }
  }
  for (int e = 0; e < elements(); ++e) {
    if (!change.isNew(e)) continue;
    setPlay(e, loop(e).playFor(loads_[e] / list_[e].width, deformation(e, at)));
  }
}

void StretchEnergy::deformations(int pack, const Surface& at, double* values) const {
  kernels().edgeStrains(packs_.data(), pack, pack + 1, at.x.arrays(), values);
}

bool StretchEnergy::touches(const EdgePack& pack, const char* flags) {
  return pack.a.anyOf(flags) || pack.b.anyOf(flags);
}

void StretchEnergy::addEnergy(const Edge& edge, int /*k*/, const Loop& law, double play, const Surface& at,
                              ElasticEnergy& sum) const {
  sum.stretch += edge.length * edge.width * law.stored(play, strain(edge, at.x));
}

}  // namespace haptic_cloth
