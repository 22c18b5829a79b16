#include "energy/internal_energy.h"

#include <algorithm>
#include <cmath>

namespace haptic_cloth {

InternalEnergy::InternalEnergy(const Fabric& fabric, const ActiveMesh& mesh)
    : mesh_(mesh),
      stretch_(fabric.tensile, mesh),
      bend_(fabric.bending, mesh),
      shear_(fabric.shear, fabric.twist_rigidity, mesh),
      normals_(mesh, fabric.twist_rigidity > 0.0),
      before_normals_(mesh, fabric.twist_rigidity > 0.0),
      change_(mesh),
      gather_(mesh, {!bend_.isZero(), !shear_.isZero(), fabric.twist_rigidity > 0.0}) {
  slots_.reserve(NodeGather::capacity(mesh));
  resize();
  stretch_.forget();
  bend_.forget();
  shear_.forget();
}

void InternalEnergy::resize() {
  gather_.rebuild(mesh_);
  slots_.clear(gather_.slots());
  stretch_.resize(gather_.edges());
  bend_.resize(gather_.triples());
  shear_.resize(gather_.patches());
}

void InternalEnergy::appendAwake(const std::vector<char>& awake, Runs& runs) const {
  stretch_.appendAwake(awake, 0, runs);
  bend_.appendAwake(awake, gather_.firstTriple(), runs);
  shear_.appendAwake(awake, gather_.firstPatch(), runs);
}

/// Calls visit(energy, run) for the parts of places begin..end that belong to edges and triples of
/// both directions and to patches.
template <class Self, class Visit>
void InternalEnergy::forRuns(Self& self, int begin, int end, const Visit& visit) {
  const auto cut = [&](auto& energy, int kind, int first, int last, int direction) {
    first = std::max(begin, first);
    last = std::min(end, last);
    if (first < last) visit(energy, PackRun{(first - kind) / kPack, (last - kind) / kPack, direction, first});
  };
  const auto [warp_edges, weft_edges, triples, weft_triples, patches] = self.starts();
  cut(self.stretch_, warp_edges, warp_edges, weft_edges, kWarp);
  cut(self.bend_, triples, triples, weft_triples, kWarp);
  cut(self.stretch_, warp_edges, weft_edges, triples, kWeft);
  cut(self.bend_, triples, weft_triples, patches, kWeft);
  cut(self.shear_, patches, patches, self.size(), kWarp);
}

InternalEnergy::Energy InternalEnergy::evaluate(int begin, int end, const Field& x) {
  Energy sum;
  forRuns(*this, begin, end,
          [&](auto& energy, const PackRun& run) { energy.evaluate(run, at(x), slots_.arrays(), sum); });
  return sum;
}

double InternalEnergy::quadraticForm(int begin, int end, const Field& d) const {
  double sum = 0.0;
  forRuns(*this, begin, end,
          [&](const auto& energy, const PackRun& run) { energy.addQuadraticForm(run, d, normals_, sum); });
  return sum;
}

void InternalEnergy::addBlocks(int part, int parts, BlockField& blocks) const {
  const auto share = [&](const auto& energy) {
    const long packs = energy.packs();
    energy.addBlocks(static_cast<int>(packs * part / parts), static_cast<int>(packs * (part + 1) / parts),
                     normals_, blocks);
  };
  share(stretch_);
  share(bend_);
  share(shear_);
}

void InternalEnergy::commit(int begin, int end, const Field& x) {
  forRuns(*this, begin, end, [&](auto& energy, const PackRun& run) { energy.commit(run, at(x)); });
}

void InternalEnergy::beginChange(const Field& x) {
  change_.begin(mesh_, x);
  stretch_.beginChange();
  bend_.beginChange();
  shear_.beginChange();
  before_normals_ = normals_;
}

void InternalEnergy::endChange(const Field& x) {
  change_.end(mesh_, x);
  stretch_.endChange(change_.edges());
  bend_.endChange(change_.triples());
  shear_.endChange(change_.patches());
}

double InternalEnergy::madeByChange(const Field& x) const {
  double made = 0.0;
  stretch_.addMade(change_.edges(), before(), at(x), made);
  bend_.addMade(change_.triples(), before(), at(x), made);
  shear_.addMade(change_.patches(), before(), at(x), made);
  return made;
}

void InternalEnergy::remember(const Field& x, ForceHistory& history) const {
  stretch_.remember(at(x), history);
  bend_.remember(at(x), history);
  shear_.remember(at(x), history);
}

void InternalEnergy::recall(const Field& x, ForceHistory& history) {
  stretch_.recall(change_.edges(), at(x), history);
  bend_.recall(change_.triples(), history);
  shear_.recall(change_.patches(), at(x), history);
}

void InternalEnergy::serialize(Archive& archive) {
  archive("edges", stretch_);
  archive("triples", bend_);
  archive("patches", shear_);
  normals_.serialize(archive);
}

InternalEnergy::Energy InternalEnergy::stored(const Field& x) const {
  Energy energy;
  stretch_.addStored(at(x), energy);
  bend_.addStored(at(x), energy);
  bend_.addTurned(at(x), energy);
  shear_.addStored(at(x), energy);
  return energy;
}

double InternalEnergy::deformation(int element, const Field& x) const {
  const auto [kind, k] = this->kind(element);
  if (kind == Kind::Edge) return stretch_.deformation(k, at(x));
  return kind == Kind::Triple ? bend_.deformation(k, at(x)) : shear_.deformation(k, at(x));
}

Curve::Point InternalEnergy::law(int element, double deformation) const {
  const auto [kind, k] = this->kind(element);
  if (kind == Kind::Edge) return stretch_.law(k, deformation);
  return kind == Kind::Triple ? bend_.law(k, deformation) : shear_.law(k, deformation);
}

double InternalEnergy::area(int element) const {
  const auto [kind, k] = this->kind(element);
  if (kind == Kind::Edge) return stretch_.area(k);
  return kind == Kind::Triple ? bend_.area(k) : shear_.area(k);
}

double InternalEnergy::maxStrain(const Field& x) const {
  double largest = 0.0;
  for (int e = 0; e < stretch_.elements(); ++e) {
    largest = std::max(largest, std::abs(stretch_.deformation(e, at(x))));
  }
  return largest;
}

}  // namespace haptic_cloth
