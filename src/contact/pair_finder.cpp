#include "contact/pair_finder.h"

#include <algorithm>
#include <cmath>
#include <iterator>

#include "contact/pair_geometry.h"
#include "mesh/list_by_node.h"

namespace haptic_cloth {
namespace {

// Range of lines over that of nodes and triangles: flat layers press by their nodes alone.
constexpr double kLineRange = 0.25;
// Distance up to which pairs of nodes are listed, over the range: triangles a little beyond the range share
// the pressure of a node, by less than 1 % beyond this.
constexpr double kGroupReach = 1.15;
// Range over the distance in the flat cloth, at most. ClothTree leaves out parts whose distance is at
// least this share of it.
constexpr double kShareOfRest = 0.5;

// By how much smooth parts are smoother than they need be where pairs are not searched again for some time.
constexpr double kSpare = 0.15;

// Pairs nearer than this share of their range at the start of a step are left out: nothing tells on
// which side they belong. Solves keep others a hundred times as far apart (SelfContact::maxStep()).
constexpr double kTogether = 1e-8;

using Point = Eigen::Vector2d;

double distance(const Point& p, const Point& a, const Point& b) {
  const Point side = b - a;
  const double t = std::clamp((p - a).dot(side) / side.squaredNorm(), 0.0, 1.0);
  return (p - a - t * side).norm();
}

double cross(const Point& a, const Point& b) { return a.x() * b.y() - a.y() * b.x(); }

/// Distance of a point from a triangle in the plane.
double distance(const Point& p, const Point& a, const Point& b, const Point& c) {
  const double turns[] = {cross(b - a, p - a), cross(c - b, p - b), cross(a - c, p - c)};
  const bool left = turns[0] >= 0.0 && turns[1] >= 0.0 && turns[2] >= 0.0,
             right = turns[0] <= 0.0 && turns[1] <= 0.0 && turns[2] <= 0.0;
  if (left || right) return 0.0;
  return std::min({distance(p, a, b), distance(p, b, c), distance(p, c, a)});
}

template <class Nodes>
double largestDeviation(const PairFinder::Reach& reach, const Nodes& nodes) {
  double largest = 0.0;
  for (const int n : nodes) largest = std::max(largest, reach.deviation[n]);
  return largest;
}

/// Largest motion of two groups of nodes relative to each other [m].
template <class Nodes, class Others>
double apart(const PairFinder::Reach& reach, const Nodes& ones, const Others& others) {
  double moved = 0.0;
  for (const int a : ones) {
    for (const int b : others) moved = std::max(moved, (reach.motion[a] - reach.motion[b]).squaredNorm());
  }
  return std::sqrt(moved) + largestDeviation(reach, ones) + largestDeviation(reach, others);
}

/// Tells whether two parts that are farther apart than `within` stay so on their expected way: if the
/// direction between their nearest points separates them at its end, it does so all along it.
/// @param between from the nearest point of the others to that of the first nodes [m]
template <class Nodes, class Others>
bool staysApart(const PairFinder::Reach& reach, const Field& nodes, const Nodes& ones, const Others& others,
                const Vec3& between, double within) {
  constexpr double kShareLeft = 0.1;  // of their distance, as in SelfContact::maxStep()
  const double distance = between.norm(),
               least = within + largestDeviation(reach, ones) + largestDeviation(reach, others);
  if (!(distance > least)) return false;
  const double enough = distance * std::max(least, kShareLeft * distance);
  for (const int a : ones) {
    for (const int b : others) {
      if (!(between.dot(nodes[a] + reach.motion[a] - nodes[b] - reach.motion[b]) > enough)) return false;
    }
  }
  return true;
}

/// Tells whether all nodes stay within a distance of some places on their expected way [m].
bool staysWithin(const PairFinder::Reach& reach, const Field& nodes, const Field& places, double distance) {
  for (int n = 0; n < nodes.size(); ++n) {
    const double away = (nodes[n] - places[n]).norm() + reach.motion[n].norm() + reach.deviation[n];
    if (!(away <= distance)) return false;
  }
  return true;
}

/// An empty pack: its lanes refer to node 0 and have no range.
PairPack emptyPack(int stack, bool lines) {
  PairPack pack{};
  std::fill(std::begin(pack.per_range), std::end(pack.per_range), 1.0);
  pack.stack = stack;
  pack.lines = lines;
  return pack;
}

}  // namespace

PairFinder::PairFinder(const Grid& grid, double thickness)
    : grid_(grid), thickness_(thickness), surface_(grid), tree_(grid) {
  margins_.reserve(grid.particles());
  const std::size_t lines = 3 * static_cast<std::size_t>(grid.particles()), points = grid.particles() + lines;
  middle_of_.reserve(lines);
  areas_.reserve(points);
  rows_.reserve(points + 2);
  deviation_.reserve(grid.particles());
  for (Field* field : {&motion_, &clear_at_, &smooth_at_}) field->reserve(grid.particles());
  for (auto* list : {&points_, &lines_, &sorted_}) list->reserve(grid.particles());
  groups_.reserve(grid.particles());
}

void PairFinder::rebuild(const ActiveMesh& mesh) {
  surface_.rebuild(mesh);
  tree_.rebuild(mesh);
  clear_ = false;
}

void PairFinder::find(const ActiveMesh& mesh, const Field& nodes, const ConstArrays& normals,
                      const Reach& reach, const std::vector<char>& dented, std::vector<PairPack>& packs) {
  normals_ = normals;
  packs.clear();
  if (isClear(mesh, nodes, reach) || becomesClear(mesh, nodes, reach)) return;
  layPoints(mesh, dented);
  search(mesh, nodes, reach, kGroupReach * thickness_, kLineRange * kGroupReach * thickness_);
  sortByPoint();
  listGroups(packs);
  listLines(packs);
  middle_of_.clear();
  for (PairPack& pack : packs) {
    for (PackIndices& list : pack.nodes) list.finish();
  }
}

/// Tells whether a search cannot find anything: nothing was near clear_at_, the ways of all nodes are within
/// the clearance there, and what was smooth is so.
bool PairFinder::isClear(const ActiveMesh& mesh, const Field& nodes, const Reach& reach) {
  clear_ = clear_ && staysWithin(reach, nodes, clear_at_, clearance()) && areSmooth(mesh, nodes);
  return clear_;
}

bool PairFinder::areSmooth(const ActiveMesh& mesh, const Field& nodes) {
  if (tree_.keepsSmooth(mesh, smooth_at_, nodes, spare_)) return true;
  spare_ = tree_.spareAt(mesh, nodes);
  smooth_at_ = nodes;
  return spare_ >= 0.0;
}

/// Searches for pairs that are near, or may come near in the next steps, if the nodes are slow enough.
/// @return whether there are none
bool PairFinder::becomesClear(const ActiveMesh& mesh, const Field& nodes, const Reach& reach) {
  constexpr int kWait = 30;           // searches after one that found something
  constexpr double kShare = 0.5;      // of the clearance, so that it lasts for some steps
  constexpr double kRounding = 1e-6;  // relative
  if (wait_ > 0) {
    --wait_;
    return false;
  }
  if (!staysWithin(reach, nodes, nodes, kShare * clearance())) return false;
  motion_.clear(mesh.nodes());
  deviation_.assign(mesh.nodes(), (1.0 + kRounding) * clearance());
  // Lines as far apart as this have no middles that press, wherever a probe touches.
  search(mesh, nodes, {motion_, deviation_}, kGroupReach * thickness_, kGroupReach * thickness_, kSpare);
  clear_ = points_.empty() && lines_.empty();
  if (clear_) {
    clear_at_ = smooth_at_ = nodes;
    spare_ = kSpare;
  } else {
    wait_ = kWait;
  }
  return clear_;
}

/// Lists all pairs of points and triangles that may come within a distance of each other, and all pairs of
/// lines that may within a smaller one [m].  @param spare as for ClothTree::forNear()
void PairFinder::search(const ActiveMesh& mesh, const Field& nodes, const Reach& reach, double within,
                        double lines_within, double spare) {
  within_ = within;
  lines_within_ = lines_within;
  margins_.resize(mesh.nodes());
  for (int n = 0; n < mesh.nodes(); ++n) margins_[n] = reach.deviation[n] + 0.5 * within;
  tree_.fit(mesh, nodes, reach.motion, margins_);
  points_.clear();
  lines_.clear();
  tree_.forNear(spare, [&](int a, int b) { addPatches(mesh, nodes, reach, a, b); });
}

bool PairFinder::mayMeetUnlisted(const ActiveMesh& mesh, const Field& start, const Field& end, bool deviates,
                                 const std::vector<PairPack>& packs) {
  if (tree_.turnsLittle(mesh, start, end) && !deviates) return false;
  clear_ = false;
  motion_.resize(mesh.nodes());
  for (int n = 0; n < mesh.nodes(); ++n) motion_.set(n, end[n] - start[n]);
  deviation_.assign(mesh.nodes(), 0.0);
  do {  // parts of what was rough may seem smooth at the start
    search(mesh, start, {motion_, deviation_}, 0.0, 0.0);
  } while (!tree_.staysSmooth(mesh, end));
  if (points_.empty() && lines_.empty()) return false;
  listed_.clear();
  for (const PairPack& pack : packs) {
    for (int l = 0; l < kPack; ++l) {
      if (pack.range[l] > 0.0 && !isMiddle(pack, l)) listed_.push_back(nodesOf(pack, l));
    }
  }
  std::sort(listed_.begin(), listed_.end());
  const auto isListed = [this](const Candidate& c) {
    return std::binary_search(listed_.begin(), listed_.end(), c.nodes);
  };
  return !std::all_of(points_.begin(), points_.end(), isListed) ||
         !std::all_of(lines_.begin(), lines_.end(), isListed);
}

void PairFinder::beginChange(const ActiveMesh& mesh, const Field& nodes) {
  motion_.clear(mesh.nodes());
  deviation_.assign(mesh.nodes(), 0.0);
  normals_ = motion_.arrays();  // sides do not matter
  clear_ = false;
  forgetRough();
  tree_.fit(mesh, nodes, motion_, deviation_);
}

bool PairFinder::hasRoom(const ActiveMesh& mesh, const Field& nodes, const Cell& cell, double moved,
                         double least) {
  if (moved < 1e-12 * grid_.shortestSpacing()) return true;  // rounding
  // Both parts of a pair may move.
  within_ = lines_within_ = least + 2.0 * moved;
  points_.clear();
  lines_.clear();
  return tree_.allAround(cell, within_, [&](int a, int b) {
    addPatches(mesh, nodes, {motion_, deviation_}, a, b);
    return points_.empty() && lines_.empty();
  });
}

/// Adds the pairs of two patches, which may be the same.
void PairFinder::addPatches(const ActiveMesh& mesh, const Field& nodes, const Reach& reach, int a, int b) {
  most_ = tree_.largestMotion(a, b) + largestDeviation(reach, mesh.patches[a].nodes) +
          largestDeviation(reach, mesh.patches[b].nodes);
  for (int swap = 0; swap < (a == b ? 1 : 2); ++swap) {
    const int of = swap ? b : a, on = swap ? a : b;
    const TriangleSurface::Range own = surface_.nodesOf(of);
    for (int k = own.begin; k < own.end; ++k) {
      const int n = surface_.node(k);
      for (const int half : {0, 1}) addPoint(mesh, nodes, reach, n, {n, n}, surface_.triangle(on, half));
    }
    const TriangleSurface::Range lines = surface_.linesOf(of);
    for (int k = lines.begin; !middle_of_.empty() && k < lines.end; ++k) {
      if (middle_of_[k] < 0) continue;
      for (const int half : {0, 1})
        addPoint(mesh, nodes, reach, middle_of_[k], surface_.line(k), surface_.triangle(on, half));
    }
  }
  const TriangleSurface::Range first = surface_.linesOf(a), second = surface_.linesOf(b);
  for (int k = first.begin; k < first.end; ++k) {
    for (int l = a == b ? k + 1 : second.begin; l < second.end; ++l) {
      addLines(mesh, nodes, reach, surface_.line(k), surface_.line(l));
    }
  }
}

void PairFinder::addPoint(const ActiveMesh& mesh, const Field& nodes, const Reach& reach, int point,
                          const TriangleSurface::Line& ends, const TriangleSurface::Triangle& t) {
  for (const int corner : t) {
    if (corner == ends.a || corner == ends.b) return;
  }
  const Vec3 p = 0.5 * (nodes[ends.a] + nodes[ends.b]), a = nodes[t[0]], b = nodes[t[1]], c = nodes[t[2]];
  const double near = within_ + most_;
  for (int k = 0; k < 3; ++k) {
    if (p[k] - near > std::max({a[k], b[k], c[k]}) || p[k] + near < std::min({a[k], b[k], c[k]})) return;
  }
  const Vec3 between = fromTriangle(p, a, b, c);
  const double distance = between.norm();
  const std::array<int, 2> both{ends.a, ends.b};
  if (distance > within_ + apart(reach, both, t) || staysApart(reach, nodes, both, t, between, within_))
    return;
  const Point place = 0.5 * (inFlatCloth(mesh, ends.a) + inFlatCloth(mesh, ends.b));
  const double range =
      rangeOf({place, inFlatCloth(mesh, t[0]), inFlatCloth(mesh, t[1]), inFlatCloth(mesh, t[2])}, false);
  const Vec3 normal(normals_.x[ends.a] + normals_.x[ends.b], normals_.y[ends.a] + normals_.y[ends.b],
                    normals_.z[ends.a] + normals_.z[ends.b]);
  if (!(distance > kTogether * range && range > 0.0)) return;
  points_.push_back(
      {{ends.a, t[0], t[1], t[2]}, range, distance, between.dot(normal) > 0.0 ? 1 : 0, point, ends.b});
}

void PairFinder::addLines(const ActiveMesh& mesh, const Field& nodes, const Reach& reach,
                          const TriangleSurface::Line& one, const TriangleSurface::Line& other) {
  if (one.a == other.a || one.a == other.b || one.b == other.a || one.b == other.b) return;
  const Vec3 a = nodes[one.a], b = nodes[one.b], c = nodes[other.a], d = nodes[other.b];
  const double near = lines_within_ + most_;
  for (int k = 0; k < 3; ++k) {
    if (std::min(a[k], b[k]) - near > std::max(c[k], d[k]) ||
        std::max(a[k], b[k]) + near < std::min(c[k], d[k]))
      return;
  }
  const Vec3 between = betweenLines(a, b, c, d);
  const double distance = between.norm();
  const std::array<int, 2> ends{one.a, one.b}, others{other.a, other.b};
  if (distance > lines_within_ + apart(reach, ends, others) ||
      staysApart(reach, nodes, ends, others, between, lines_within_))
    return;
  const std::array<int, 4> list{one.a, one.b, other.a, other.b};
  const double range = kLineRange * rangeOf({inFlatCloth(mesh, one.a), inFlatCloth(mesh, one.b),
                                             inFlatCloth(mesh, other.a), inFlatCloth(mesh, other.b)},
                                            true);
  if (distance > kTogether * range && range > 0.0) lines_.push_back({list, range, distance, 0, -1, one.a});
}

Eigen::Vector2d PairFinder::inFlatCloth(const ActiveMesh& mesh, int node) const {
  const int particle = mesh.particle[node];
  return {grid_.column(particle) * grid_.dx, grid_.row(particle) * grid_.dy};
}

/// Distance at which a pair begins to press: the thickness, or less if it is that near in the flat
/// cloth. 0 for parts that touch there.  @param p the points of the pair in the flat cloth [m]
double PairFinder::rangeOf(const std::array<Point, 4>& p, bool lines) const {
  const double rest = lines ? std::min({distance(p[0], p[2], p[3]), distance(p[1], p[2], p[3]),
                                        distance(p[2], p[0], p[1]), distance(p[3], p[0], p[1])})
                            : distance(p[0], p[1], p[2], p[3]);
  const double touching = 1e-9 * grid_.shortestSpacing();
  return rest > touching ? std::min(thickness_, kShareOfRest * rest) : 0.0;
}

/// Lays the points that press, each for an area: the nodes, and the middles of lines where a probe may dent
/// layers. There the pressure may change much within a cell. A cell's diagonal has one pair of its corners;
/// the other pair stands for more, so that even pressure loads all four alike.
void PairFinder::layPoints(const ActiveMesh& mesh, const std::vector<char>& dented) {
  constexpr double kOn = 1.0 / 36.0, kOff = 5.0 / 36.0;         // corners on and off the diagonal
  constexpr double kSide = 4.0 / 36.0, kDiagonal = 8.0 / 36.0;  // middles
  areas_.assign(mesh.nodes(), 0.0);
  middle_of_.assign(surface_.lines(), -1);
  for (std::size_t k = 0; k < mesh.patches.size(); ++k) {
    const Patch& patch = mesh.patches[k];
    if (dented[k] == 0) {
      for (const int n : patch.nodes) areas_[n] += 0.25 * patch.area;
      continue;
    }
    const int diagonal = surface_.diagonal(static_cast<int>(k));
    const TriangleSurface::Line& ends = surface_.line(diagonal);
    for (const int n : patch.nodes) areas_[n] += (n == ends.a || n == ends.b ? kOn : kOff) * patch.area;
    for (const int side : patch.sides) layMiddle(surface_.lineOf(side), kSide * patch.area);
    layMiddle(diagonal, kDiagonal * patch.area);
  }
}

/// Adds an area to the middle of a line [m²].
void PairFinder::layMiddle(int line, double area) {
  if (middle_of_[line] < 0) {
    middle_of_[line] = static_cast<int>(areas_.size());
    areas_.push_back(0.0);
  }
  areas_[middle_of_[line]] += area;
}

/// Sorts candidates of points by point, side and distance.
void PairFinder::sortByPoint() {
  const int points = static_cast<int>(areas_.size());
  const auto visit = [this](const auto& put) {
    for (const Candidate& c : points_) put(c.point, c);
  };
  listByNode(points, visit, rows_, sorted_);
  const auto before = [](const Candidate& a, const Candidate& b) {
    if (a.side != b.side) return a.side < b.side;
    if (a.distance * b.range != b.distance * a.range) return a.distance * b.range < b.distance * a.range;
    return a.nodes < b.nodes;
  };
  for (int n = 0; n < points; ++n)
    std::sort(sorted_.begin() + rows_[n], sorted_.begin() + rows_[n + 1], before);
}

/// Finds the groups. Those that press at the start of the step come first: only their packs are evaluated
/// in most steps of the solve, and groups of one size fill their stacks best. The others come by what they
/// are out of range, because a stack is evaluated as soon as one of its groups may press.
void PairFinder::findGroups() {
  groups_.clear();
  for (int first = 0, count = static_cast<int>(sorted_.size()); first < count;) {
    const Candidate& nearest = sorted_[first];
    int end = first + 1;
    while (end < count && sorted_[end].point == nearest.point && sorted_[end].side == nearest.side) ++end;
    groups_.push_back({first, end - first, nearest.distance - nearest.range});
    first = end;
  }
  std::sort(groups_.begin(), groups_.end(), [](const Group& a, const Group& b) {
    const bool presses = a.excess < 0.0;
    if (presses != (b.excess < 0.0)) return presses;
    if (presses && a.size != b.size) return a.size > b.size;
    if (!presses && a.excess != b.excess) return a.excess < b.excess;
    return a.first < b.first;
  });
}

void PairFinder::put(PairPack& pack, int lane, const Candidate& pair, double area) {
  for (int c = 0; c < 4; ++c) pack.nodes[c].set(lane, pair.nodes[c]);
  pack.nodes[4].set(lane, pair.other);
  pack.middles = pack.middles || pair.other != pair.nodes[0];
  pack.range[lane] = pair.range;
  pack.per_range[lane] = 1.0 / pair.range;
  pack.area[lane] = area;
}

/// Lists each group in one lane of a stack.
void PairFinder::listGroups(std::vector<PairPack>& packs) {
  findGroups();
  for (std::size_t begin = 0; begin < groups_.size(); begin += kPack) {
    const std::size_t end = std::min(begin + kPack, groups_.size());
    int stack = 0;
    for (std::size_t g = begin; g < end; ++g) stack = std::max(stack, groups_[g].size);
    for (int k = 0; k < stack; ++k) {
      packs.push_back(emptyPack(k == 0 ? stack : 0, false));
      for (std::size_t g = begin; g < end; ++g) {
        if (k >= groups_[g].size) continue;
        const Candidate& c = sorted_[groups_[g].first + k];
        put(packs.back(), static_cast<int>(g - begin), c, 0.5 * areas_[c.point]);
      }
    }
  }
}

void PairFinder::listLines(std::vector<PairPack>& packs) const {
  for (std::size_t k = 0; k < lines_.size(); ++k) {
    if (k % kPack == 0) packs.push_back(emptyPack(1, true));
    put(packs.back(), k % kPack, lines_[k], thickness_ * grid_.shortestSpacing());
  }
}

}  // namespace haptic_cloth
