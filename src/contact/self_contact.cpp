#include "contact/self_contact.h"

#include <algorithm>
#include <cmath>
#include <limits>

#include "contact/friction_law.h"
#include "mesh/list_by_node.h"
#include "simd/kernels.h"

namespace haptic_cloth {
namespace {

Vec3 laneOf(const double (&values)[3][kPack], int lane) {
  return {values[0][lane], values[1][lane], values[2][lane]};
}

}  // namespace

SelfContact::SelfContact(const Grid& grid, const Options& options, double slip)
    : grid_(grid),
      law_(options.law),
      friction_(options.friction),
      slip_(slip),
      memory_(grid),
      finder_(grid, options.law.range()) {
  packs_.reserve(grid.particles() / 2);
  bounds_.reserve(grid.particles() / 2);
  paired_.reserve(grid.particles());
  places_.reserve(grid.particles());
  rows_.reserve(grid.particles() + 2);
  entries_.reserve(4 * kPack * (grid.particles() / 2));
  memory_.reserve(2 * grid.particles());
}

void SelfContact::rebuild(const ActiveMesh& mesh) {
  finder_.rebuild(mesh);
  packs_.clear();  // they name nodes of the old mesh
  bounds_.clear();
  paired_.clear();
  rows_.assign(mesh.nodes() + 1, 0);
}

void SelfContact::collect(const ActiveMesh& mesh, const Field& nodes, const ConstArrays& normals,
                          const PairFinder::Reach& reach) {
  finder_.find(mesh, nodes, normals, reach, packs_);
  listEntries(mesh.nodes());
  bounds_.assign(packs_.size(), {0.0, 0.0, 0.0});
  paired_.clear();
  places_.clear();
  for (int n = 0; n < mesh.nodes(); ++n) {
    if (rows_[n] == rows_[n + 1]) continue;
    paired_.push_back(n);
    places_.push_back(nodes[n]);
  }
  travelled_ = 0.0;
  evaluate(0, size(), nodes);  // without friction yet
  for (PairPack& pack : packs_) {
    for (int l = 0; l < kPack; ++l) {
      pack.friction[l] = friction_ * pack.pressing[l];
      for (int c = 0; c < 3; ++c) pack.start_normal[c][l] = pack.normal[c][l];
      Vec3 start = Vec3::Zero();
      for (int c = 0; c < 4; ++c) {
        pack.start_weights[c][l] = pack.weights[c][l];
        start += pack.weights[c][l] * nodes[pack.nodes[c].index[l]];
      }
      if (pack.friction[l] > 0.0) {
        const Place place = placeOf(pack, l, mesh, normals);
        const Vec3 before = pack.area[l] * memory_.find(place.face, place.at);
        start -= slip_ * slipUnder(before / pack.friction[l]);
      }
      for (int c = 0; c < 3; ++c) pack.start[c][l] = start[c];
    }
  }
}

void SelfContact::rememberFriction(const ActiveMesh& mesh, const ConstArrays& normals) {
  memory_.clear();
  forPairs([&](const PairPack& pack, int l) {
    if (!(pack.friction[l] > 0.0) || !(pack.distance[l] < pack.range[l])) return;
    const Place place = placeOf(pack, l, mesh, normals);
    memory_.add(place.face, place.at, place.half, laneOf(pack.drag, l) / pack.area[l]);
  });
}

/// The place at the start of the step, so that the step after it finds what was remembered there.
SelfContact::Place SelfContact::placeOf(const PairPack& pack, int lane, const ActiveMesh& mesh,
                                        const ConstArrays& normals) const {
  const auto at = [&](int corner) {
    const int particle = mesh.particle[pack.nodes[corner].index[lane]];
    return FlatPoint{double(grid_.column(particle)), double(grid_.row(particle))};
  };
  Place place{0, at(0), 0.5 * std::sqrt(2.0 * pack.area[lane] / (grid_.dx * grid_.dy))};
  if (pack.lines) {
    const double along = pack.start_weights[1][lane];
    place.at.u += along * (at(1).u - place.at.u);
    place.at.v += along * (at(1).v - place.at.v);
  }
  const int node = pack.nodes[0].index[lane];
  const double above =
      laneOf(pack.start_normal, lane).dot(Vec3(normals.x[node], normals.y[node], normals.z[node]));
  place.face = (pack.lines ? 2 : 0) + (above > 0.0 ? 1 : 0);
  return place;
}

void SelfContact::serialize(Archive& archive) { memory_.serialize(archive, kFaces); }

/// Lists the pairs of each node in a fixed order, so that the bits of the sums do not depend on the
/// number of threads.
void SelfContact::listEntries(int nodes) {
  const auto visit = [&](const auto& put) {
    for (int p = 0; p < static_cast<int>(packs_.size()); ++p) {
      for (int l = 0; l < kPack; ++l) {
        if (!(packs_[p].area[l] > 0.0)) continue;
        for (int c = 0; c < 4; ++c) {
          put(packs_[p].nodes[c].index[l],
              Entry{p, static_cast<unsigned char>(l), static_cast<unsigned char>(c)});
        }
      }
    }
  };
  listByNode(nodes, visit, rows_, entries_);
}

void SelfContact::place(const Field& nodes) {
  double squared = 0.0, sum = 0.0;
  for (std::size_t k = 0; k < paired_.size(); ++k) {
    const Vec3 place = nodes[paired_[k]];
    const double moved = (place - places_[k]).squaredNorm();
    squared = std::max(squared, moved);
    sum += moved;
    places_[k] = place;
  }
  // Two points may move against each other. Positions that are no numbers end all bounds.
  travelled_ += std::isfinite(sum) ? 2.0 * std::sqrt(squared) : std::numeric_limits<double>::infinity();
}

ContactEnergy SelfContact::evaluate(int begin, int end, const Field& nodes) {
  return kernels().evaluatePairs(packs_.data(), bounds_.data(), begin / kPack, end / kPack,
                                 {law_.constants(), slip_, travelled_}, nodes.arrays());
}

double SelfContact::quadraticForm(int begin, int end, const Field& d) const {
  return kernels().pairQuadraticForm(packs_.data(), bounds_.data(), begin / kPack, end / kPack, d.arrays());
}

void SelfContact::addGradient(int begin, int end, Field& gradient) const {
  for (int n = begin; n < end; ++n) {
    if (rows_[n] == rows_[n + 1]) continue;
    Vec3 sum = gradient[n];
    for (int e = rows_[n]; e < rows_[n + 1]; ++e) {
      const auto& [p, lane, corner] = entries_[e];
      if (!acts(bounds_[p])) continue;
      const PairPack& pack = packs_[p];
      if (pack.pressing[lane] > 0.0)
        sum -= pack.pressing[lane] * pack.weights[corner][lane] * laneOf(pack.normal, lane);
      if (pack.drag_stiffness[lane] > 0.0) sum += pack.start_weights[corner][lane] * laneOf(pack.drag, lane);
    }
    gradient.set(n, sum);
  }
}

void SelfContact::addSprings(Blocks& blocks) const {
  forPairs([&](const PairPack& pack, int l) {
    const double along = pack.stiffness[l], across = pack.drag_stiffness[l];
    if (along == 0.0 && across == 0.0) return;
    const Block pressed = along * square(laneOf(pack.normal, l)),
                dragged = across * (isotropic(1.0) - square(laneOf(pack.start_normal, l)));
    for (int c = 0; c < 4; ++c) {
      blocks[pack.nodes[c].index[l]] +=
          std::abs(pack.weights[c][l]) * pressed + std::abs(pack.start_weights[c][l]) * dragged;
    }
  });
}

void SelfContact::addDiagonal(Field& diagonal) const {
  forPairs([&](const PairPack& pack, int l) {
    const Vec3 normal = laneOf(pack.normal, l), start = laneOf(pack.start_normal, l);
    for (int c = 0; c < 4; ++c) {
      const double w = pack.weights[c][l], s = pack.start_weights[c][l];
      diagonal.add(pack.nodes[c].index[l],
                   w * w * pack.stiffness[l] * normal.cwiseAbs2() +
                       s * s * pack.drag_stiffness[l] * (Vec3::Ones() - start.cwiseAbs2()));
    }
  });
}

double SelfContact::maxStep(const Field& nodes, const Field& d, double most, double least_ranges) {
  constexpr double kShare = 0.9;
  double squared = 0.0;
  for (const int n : paired_) squared = std::max(squared, d[n].squaredNorm());
  const PairLimits limits{kShare, least_ranges, most, 2.0 * std::sqrt(squared), law_.range()};
  return kernels().largestPairStep(packs_.data(), bounds_.data(), 0, static_cast<int>(packs_.size()), limits,
                                   travelled_, nodes.arrays(), d.arrays());
}

void SelfContact::appendAwake(const std::vector<char>& awake, int first, Runs& runs) const {
  for (int k = 0; k < size(); k += kPack) {
    const PairPack& pack = packs_[k / kPack];
    const bool wanted =
        std::any_of(pack.nodes, pack.nodes + 4, [&](const PackIndices& n) { return n.anyOf(awake.data()); });
    if (wanted) runs.add(first + k, first + k + kPack);
  }
}

void SelfContact::markTouched(std::vector<char>& nodes) const {
  forPairs([&](const PairPack& pack, int l) {
    if (!(pack.pressing[l] > 0.0)) return;
    for (int c = 0; c < 4; ++c) {
      if (pack.weights[c][l] != 0.0) nodes[pack.nodes[c].index[l]] = 1;
    }
  });
}

int SelfContact::touching() const {
  int count = 0;
  forPairs([&](const PairPack& pack, int l) { count += pack.pressing[l] > 0.0 ? 1 : 0; });
  return count;
}

double SelfContact::smallestDistance(const Field& nodes) {
  return kernels().measurePairs(packs_.data(), bounds_.data(), 0, static_cast<int>(packs_.size()), travelled_,
                                std::numeric_limits<double>::infinity(), nodes.arrays());
}

}  // namespace haptic_cloth
