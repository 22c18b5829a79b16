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

InternalEnergy::Parts InternalEnergy::split(int begin, int end) const {
  const auto cut = [begin, end](int kind, int first, int last, int direction) {
    return PackRun{(std::clamp(begin, first, last) - kind) / kPack,
                   (std::clamp(end, first, last) - kind) / kPack, direction};
  };
  const auto both = [&cut](int kind, const PackedRange& range) {
    const int weft = kind + range.warpEnd(), last = kind + range.size();
    return std::array<PackRun, 2>{cut(kind, kind, weft, kWarp), cut(kind, weft, last, kWeft)};
  };
  const int patches = gather_.firstPatch();
  return {both(0, gather_.edges()), both(gather_.firstTriple(), gather_.triples()),
          cut(patches, patches, size(), kWarp)};
}

/// Slots of one kind of elements. @param first its first slot
MutableArrays InternalEnergy::slotsFrom(int first) {
  const MutableArrays all = slots_.arrays();
  return {all.x + first, all.y + first, all.z + first};
}

InternalEnergy::Energy InternalEnergy::evaluate(int begin, int end, const Field& x) {
  const Parts parts = split(begin, end);
  Energy energy;
  for (const int direction : {kWarp, kWeft}) {
    stretch_.evaluate(parts.edges[direction], at(x), slotsFrom(0), energy);
    bend_.evaluate(parts.triples[direction], at(x), slotsFrom(gather_.firstTriple()), energy);
  }
  shear_.evaluate(parts.patches, at(x), slotsFrom(gather_.firstPatch()), energy);
  return energy;
}

double InternalEnergy::curvature(int begin, int end, const Field& d) const {
  const Parts parts = split(begin, end);
  double sum = 0.0;
  for (const int direction : {kWarp, kWeft}) {
    stretch_.addCurvature(parts.edges[direction], d, sum);
    bend_.addCurvature(parts.triples[direction], d, normals_, sum);
  }
  shear_.addCurvature(parts.patches, d, normals_, sum);
  return sum;
}

void InternalEnergy::addBlocks(int part, int parts, BlockField& blocks) const {
  const auto border = [parts](int packs, int k) {
    return static_cast<int>(static_cast<long>(packs) * k / parts);
  };
  stretch_.addBlocks(border(stretch_.packs(), part), border(stretch_.packs(), part + 1), blocks);
  bend_.addBlocks(border(bend_.packs(), part), border(bend_.packs(), part + 1), normals_, blocks);
  shear_.addBlocks(border(shear_.packs(), part), border(shear_.packs(), part + 1), normals_, blocks);
}

void InternalEnergy::commit(int begin, int end, const Field& x) {
  const Parts parts = split(begin, end);
  for (const int direction : {kWarp, kWeft}) {
    stretch_.commit(parts.edges[direction], at(x));
    bend_.commit(parts.triples[direction], at(x));
  }
  shear_.commit(parts.patches, at(x));
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
