#include "contact/self_contact.h"

#include <algorithm>
#include <cmath>
#include <limits>

#include "contact/friction_law.h"
#include "contact/pair_geometry.h"
#include "simd/kernels.h"

namespace haptic_cloth {
namespace {

constexpr double kShare = 0.9;  // of its distance that a pair may use up in one step of a solve

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
  drags_.reserve(grid.particles() / kPack + 1);
  is_paired_.reserve(grid.particles());
  paired_.reserve(grid.particles());
  last_positions_.reserve(grid.particles());
  gradient_.reserve(grid.particles());
  memory_.reserve(2 * grid.particles());
}

void SelfContact::rebuild(const ActiveMesh& mesh) {
  finder_.rebuild(mesh);
  packs_.clear();  // they name nodes of the old mesh
  bounds_.clear();
  drags_.clear();
  paired_.clear();
}

void SelfContact::collect(const ActiveMesh& mesh, const Field& nodes, const ConstArrays& normals,
                          const PairFinder::Reach& reach, const std::vector<char>& dented) {
  finder_.find(mesh, nodes, normals, reach, dented, packs_);
  bounds_.clear();
  for (const PairPack& pack : packs_) bounds_.push_back({0.0, 0.0, 0.0, pack.stack, false});
  drags_.clear();
  listPaired(nodes);
  travelled_ = 0.0;
  evaluate(0, size(), nodes);
  if (friction_ > 0.0) listDrags(mesh, nodes, normals);
}

/// Lists the nodes of all pairs.
void SelfContact::listPaired(const Field& nodes) {
  paired_.clear();
  last_positions_.clear();
  is_paired_.assign(nodes.size(), 0);
  forPairs([&](const PairPack& pack, int l) {
    for (const PackIndices& corner : pack.nodes) {
      const int n = corner.index[l];
      if (is_paired_[n]) continue;
      is_paired_[n] = 1;
      paired_.push_back(n);
      last_positions_.push_back(nodes[n]);
    }
  });
}

/// Lists the friction of all points and lines that press at the start of the step: it acts at their nearest
/// pair.
void SelfContact::listDrags(const ActiveMesh& mesh, const Field& nodes, const ConstArrays& normals) {
  constexpr double kLeastPressing = 1e-100;  // [N]; divisions by less overflow
  int lane = kPack;
  forStacks([&](int first, int l) {
    double pressing = 0.0;
    int nearest = first;
    for (int p = first; p < first + bounds_[first].stack; ++p) {
      pressing += packs_[p].pressing[l];
      if (packs_[p].distance[l] < packs_[nearest].distance[l]) nearest = p;
    }
    if (!(pressing > kLeastPressing)) return;
    if (lane == kPack) {
      drags_.push_back({});
      lane = 0;
    }
    beginDrag(drags_.back(), lane++, kPack * nearest + l, friction_ * pressing, mesh, nodes, normals);
  });
  for (DragPack& drag : drags_) {
    for (PackIndices& list : drag.nodes) list.finish();
  }
}

/// Begins friction at a pair with the slip under which it holds what it held before.
void SelfContact::beginDrag(DragPack& drag, int lane, int pair, double limit, const ActiveMesh& mesh,
                            const Field& nodes, const ConstArrays& normals) {
  const PairPack& pack = packs_[pair / kPack];
  const int l = pair % kPack;
  for (int c = 0; c < 5; ++c) drag.nodes[c].set(lane, pack.nodes[c].index[l]);
  for (int c = 0; c < 4; ++c) drag.weights[c][lane] = pack.weights[c][l];
  drag.middles = drag.middles || isMiddle(pack, l);
  Vec3 start = Vec3::Zero();
  forNodes(pack, l, [&](int n, double weight) { start += weight * nodes[n]; });
  drag.limit[lane] = limit;
  drag.pair[lane] = pair;
  for (int c = 0; c < 3; ++c) drag.normal[c][lane] = pack.normal[c][l];
  const Place place = placeOf(drag, lane, mesh, normals);
  start -= slip_ * slipUnder(pack.area[l] * memory_.find(place.face, place.at) / limit);
  for (int c = 0; c < 3; ++c) drag.start[c][lane] = start[c];
}

void SelfContact::rememberFriction(const ActiveMesh& mesh, const ConstArrays& normals) {
  memory_.clear();
  forDrags([&](const DragPack& drag, int l) {
    const PairPack& pack = packs_[drag.pair[l] / kPack];
    const int lane = drag.pair[l] % kPack;
    if (!(pack.distance[lane] < pack.range[lane])) return;
    const Place place = placeOf(drag, l, mesh, normals);
    memory_.add(place.face, place.at, place.half, laneOf(drag.drag, l) / pack.area[lane]);
  });
}

/// The place at the start of the step, so that the step after it finds what was remembered there.
SelfContact::Place SelfContact::placeOf(const DragPack& drag, int lane, const ActiveMesh& mesh,
                                        const ConstArrays& normals) const {
  const PairPack& pack = packs_[drag.pair[lane] / kPack];
  const double area = pack.area[drag.pair[lane] % kPack];
  const auto at = [&](int corner) {
    const int particle = mesh.particle[drag.nodes[corner].index[lane]];
    return FlatPoint{double(grid_.column(particle)), double(grid_.row(particle))};
  };
  const auto normal = [&](int corner) {
    const int n = drag.nodes[corner].index[lane];
    return Vec3(normals.x[n], normals.y[n], normals.z[n]);
  };
  Place place{0, at(0), 0.5 * std::sqrt(2.0 * area / (grid_.dx * grid_.dy))};
  const double along = pack.lines ? drag.weights[1][lane] : 0.5;
  const int end = pack.lines ? 1 : 4;
  place.at.u += along * (at(end).u - place.at.u);
  place.at.v += along * (at(end).v - place.at.v);
  const Vec3 outward = pack.lines ? normal(0) : normal(0) + normal(4);
  const double above = laneOf(drag.normal, lane).dot(outward);
  place.face = (pack.lines ? 2 : 0) + (above > 0.0 ? 1 : 0);
  return place;
}

void SelfContact::serialize(Archive& archive) { memory_.serialize(archive, kFaces); }

void SelfContact::noteMotion(const Field& nodes) {
  double squared = 0.0, sum = 0.0;
  for (std::size_t k = 0; k < paired_.size(); ++k) {
    const Vec3 place = nodes[paired_[k]];
    const double moved = (place - last_positions_[k]).squaredNorm();
    squared = std::max(squared, moved);
    sum += moved;
    last_positions_[k] = place;
  }
  // Two points may move against each other. Positions that are no numbers end all bounds.
  travelled_ += std::isfinite(sum) ? 2.0 * std::sqrt(squared) : std::numeric_limits<double>::infinity();
  // Small motions must not vanish beside a long way.
  constexpr double kLongest = 1e6;  // [ranges]
  if (travelled_ > kLongest * law_.range()) {
    travelled_ = 0.0;
    for (PairBound& bound : bounds_) bound.forget();
  }
}

ContactEnergy SelfContact::evaluate(int begin, int end, const Field& nodes) {
  const int pairs = static_cast<int>(packs_.size()), first = begin / kPack, last = end / kPack;
  ContactEnergy energy{0.0, 0.0};
  energy.contact =
      kernels().evaluatePairs(packs_.data(), bounds_.data(), std::min(first, pairs), std::min(last, pairs),
                              {law_.constants(), travelled_}, nodes.arrays());
  energy.friction = kernels().evaluateDrags(drags_.data(), std::max(first, pairs) - pairs,
                                            std::max(last, pairs) - pairs, slip_, nodes.arrays());
  return energy;
}

double SelfContact::quadraticForm(int begin, int end, const Field& d) const {
  const int pairs = static_cast<int>(packs_.size()), first = begin / kPack, last = end / kPack;
  return kernels().pairQuadraticForm(packs_.data(), bounds_.data(), std::min(first, pairs),
                                     std::min(last, pairs), d.arrays()) +
         kernels().dragQuadraticForm(drags_.data(), std::max(first, pairs) - pairs,
                                     std::max(last, pairs) - pairs, slip_, d.arrays());
}

void SelfContact::sumForces(int nodes) {
  if (packs_.empty()) return;
  gradient_.resize(nodes);
  for (const int n : paired_) gradient_.set(n, Vec3::Zero());
  forPressing([&](const PairPack& pack, int l) {
    const Vec3 force = pack.pressing[l] * laneOf(pack.normal, l);
    forNodes(pack, l, [&](int n, double weight) { gradient_.add(n, -weight * force); });
  });
  forDrags([&](const DragPack& drag, int l) {
    const Vec3 force = laneOf(drag.drag, l);
    forNodes(drag, l, [&](int n, double weight) { gradient_.add(n, weight * force); });
  });
}

void SelfContact::addGradient(int begin, int end, Field& gradient) const {
  if (packs_.empty()) return;
  for (int n = begin; n < end; ++n) {
    if (is_paired_[n]) gradient.add(n, gradient_[n]);
  }
}

Block SelfContact::springOf(const DragPack& drag, int lane) const {
  return frictionBlock(laneOf(drag.slip, lane), laneOf(drag.normal, lane), drag.limit[lane], slip_);
}

void SelfContact::addSprings(Blocks& blocks) const {
  // The stiffness of a pair that is squeezed to nearly nothing would hold its nodes fast, though they may
  // move together, and a solve would jam. So it stops growing below some distance.
  constexpr double kNearest = 0.3;  // [ranges]
  forSprings(kNearest, [&](const PairPoints& points, int l, const Block& spring) {
    forNodes(points, l, [&](int n, double weight) { blocks[n] += std::abs(weight) * spring; });
  });
}

void SelfContact::addDiagonal(Field& diagonal) const {
  forPressing([&](const PairPack& pack, int l) {
    const Vec3 squared = pack.stiffness[l] * laneOf(pack.normal, l).cwiseAbs2();
    forNodes(pack, l, [&](int n, double weight) { diagonal.add(n, weight * weight * squared); });
  });
  forDrags([&](const DragPack& drag, int l) {
    const Vec3 dragged = springOf(drag, l).head<3>();
    forNodes(drag, l, [&](int n, double weight) { diagonal.add(n, weight * weight * dragged); });
  });
}

double SelfContact::maxStep(const Field& nodes, const Field& d, double most, double least_ranges) {
  double squared = 0.0;
  for (const int n : paired_) squared = std::max(squared, d[n].squaredNorm());
  const PairLimits limits{kShare, least_ranges, most, 2.0 * std::sqrt(squared), law_.range()};
  return kernels().largestPairStep(packs_.data(), bounds_.data(), 0, static_cast<int>(packs_.size()), limits,
                                   travelled_, nodes.arrays(), d.arrays());
}

bool SelfContact::keepClear(const Field& nodes, const Field& d, double step, Field& change) const {
  bool changed = false;
  forPairs([&](const PairPack& pack, int l) {
    if (bounds_[&pack - packs_.data()].measured != travelled_) return;  // too far apart
    const Vec3 normal = laneOf(pack.normal, l);
    const auto of = [&](const Field& values, int point) -> Vec3 {
      const Vec3 value = values[pack.nodes[point].index[l]];
      return point == 0 && isMiddle(pack, l) ? 0.5 * (value + values[pack.nodes[4].index[l]]) : value;
    };
    const auto move = [&](int point, const Vec3& way) {
      change.add(pack.nodes[point].index[l], way);
      if (point == 0 && isMiddle(pack, l)) change.add(pack.nodes[4].index[l], way);
    };
    // As in largestPairStep() each point of the first part may meet each of the second.
    const int firsts = pack.lines ? 2 : 1;
    for (int a = 0; a < firsts; ++a) {
      for (int b = firsts; b < 4; ++b) {
        const double apart = std::max(0.0, normal.dot(of(nodes, a) - of(nodes, b)));
        const double closing = normal.dot(of(d, b) + of(change, b) - of(d, a) - of(change, a));
        const double excess = closing - kShare * apart / step;
        if (!(excess > 0.0)) continue;
        move(a, 0.5 * excess * normal);
        move(b, -0.5 * excess * normal);
        changed = true;
      }
    }
  });
  return changed;
}

bool SelfContact::pairsStayApart(const Field& start, const Field& end) const {
  double squared = 0.0;
  for (const int n : paired_) squared = std::max(squared, (end[n] - start[n]).squaredNorm());
  const StraightWay way{start.arrays(), end.arrays(), 2.0 * std::sqrt(squared), travelled_};
  const int packs = static_cast<int>(packs_.size());
  for (int p = 0; p < packs; ++p) {
    p = kernels().firstPassing(packs_.data(), bounds_.data(), p, packs, way);
    for (int l = 0; p < packs && l < kPack; ++l) {
      const PairPack& pack = packs_[p];
      // Surfaces do not begin to cross at middles of lines.
      const bool counts = pack.range[l] > 0.0 && !isMiddle(pack, l);
      if (counts && !staysApartOnWay(nodesOf(pack, l), pack.lines, start, end)) return false;
    }
  }
  return true;
}

void SelfContact::appendAwake(const std::vector<char>& awake, int first, Runs& runs) const {
  const auto isAwake = [&awake](const auto& pack) {
    return std::any_of(std::begin(pack.nodes), std::end(pack.nodes),
                       [&](const PackIndices& n) { return n.anyOf(awake.data()); });
  };
  for (auto pack = packs_.begin(); pack != packs_.end();) {
    const auto next = pack + pack->stack;
    const int end = first + kPack * pack->stack;
    if (std::any_of(pack, next, isAwake)) runs.add(first, end);
    first = end;
    pack = next;
  }
  for (const DragPack& drag : drags_) {
    if (isAwake(drag)) runs.add(first, first + kPack);
    first += kPack;
  }
}

void SelfContact::markListed(std::vector<char>& nodes) const {
  forPairs([&](const PairPack& pack, int l) {
    forNodes(pack, l, [&](int n, double weight) {
      if (weight != 0.0) nodes[n] = 1;
    });
  });
}

int SelfContact::touching() const {
  int count = 0;
  forStacks([&](int first, int l) {
    const auto presses = [l](const PairPack& pack) { return pack.pressing[l] > 0.0; };
    const auto begin = packs_.begin() + first;
    count += std::any_of(begin, begin + bounds_[first].stack, presses) ? 1 : 0;
  });
  return count;
}

double SelfContact::smallestDistance(const Field& nodes) {
  return kernels().measurePairs(packs_.data(), bounds_.data(), 0, static_cast<int>(packs_.size()), travelled_,
                                std::numeric_limits<double>::infinity(), nodes.arrays());
}

}  // namespace haptic_cloth
