#include "contact/contact_set.h"

#include <algorithm>
#include <cmath>
#include <string>

#include "simd/kernels.h"

namespace haptic_cloth {
namespace {

constexpr int kChunk = 512;   // growth of the arrays of points [points]
constexpr double kCut = 0.5;  ///< depth in ranges that a sharp edge may cut into a cell
/// Smallest number of samples across half the width of a probe.
constexpr double kStart = 3e-8;  ///< time that the start of a sample takes, about [s]
constexpr double kProbeSpacing = 3.0;

}  // namespace

ContactSet::ContactSet(const Grid& grid, const std::vector<Obstacle>& obstacles,
                       const std::vector<ProbeOptions>& probes, const Options& options, Team& team)
    : options_(options),
      team_(team),
      law_(options.range),
      grid_(grid),
      obstacles_(static_cast<int>(obstacles.size())),
      solids_(obstacles.begin(), obstacles.end()) {
  for (const Obstacle& obstacle : obstacles) targets_.push_back(obstacle.pose);
  for (const ProbeOptions& probe : probes) solids_.emplace_back(probe);
  before_ = solids_;
  const int solids = static_cast<int>(solids_.size()), capacity = sampleCapacity();
  for (auto* samples : {&samples_, &started_}) samples->reserve(capacity);
  near_.reserve(capacity);
  groups_.reserve(2 * solids);
  packs_.reserve(capacity / kPack + 1);
  for (Field* field : {&gradient_, &change_}) field->reserve(capacity);
  entries_.reserve(4 * static_cast<std::size_t>(capacity));
  rows_.reserve(grid.particles() + 1);
  for (auto* list : {&node_area_, &still_}) list->reserve(grid.particles());
  node_gaps_.reserve(padded(grid.particles()));
  patch_margins_.reserve(padded(grid.cells()));
  node_normals_.reserve(grid.particles());
  margins_.reserve(capacity);
  points_.reserve(capacity);
  places_.reserve(capacity + kChunk);
  for (auto& gaps : sample_gaps_) gaps.reserve(padded(capacity));
  for (Field& normals : sample_normals_) normals.reserve(capacity);
}

/// Number of samples to reserve. If a finest cell has at most one sample of a solid, cells two
/// finest cells wide under an uneven solid need most: five samples and one node in four finest
/// cells. Otherwise the number comes from experience with scenes; a step that needs more allocates.
int ContactSet::sampleCapacity() const {
  const int particles = grid_.particles(), solids = static_cast<int>(solids_.size());
  const double spacing = std::max(grid_.dx, grid_.dy);
  bool fine = chord(2.0) <= kCut * law_.range();
  for (int k = obstacles_; k < solids; ++k) fine = fine && spacing <= solids_[k].halfWidth() / kProbeSpacing;
  const int places = fine ? (particles + particles / 2) * solids : 4 * particles * (solids + 1);
  return places + 2 * kPack * solids;
}

void ContactSet::serialize(Archive& archive) {
  for (int k = 0; k < obstacles_; ++k) {  // probes are placed in each step
    archive("now[" + std::to_string(k) + "]", solids_[k]);
    archive("before[" + std::to_string(k) + "]", before_[k]);
  }
  archive.each("target_positions", targets_, &Pose::position);
  archive.each("target_orientations", targets_, &Pose::orientation);
}

Vec3 ContactSet::at(const SurfacePoint& point, const Field& values) {
  return point.weights[0] * values[point.nodes[0]] + point.weights[1] * values[point.nodes[1]] +
         point.weights[2] * values[point.nodes[2]] + point.weights[3] * values[point.nodes[3]];
}

void ContactSet::startProbe(int probe, const Vec3& proxy, const Quat& before, const Quat& after) {
  Solid &now = solids_[obstacles_ + probe], &then = before_[obstacles_ + probe];
  for (Solid* solid : {&now, &then}) solid->place(proxy);
  now.turn(after);
  then.turn(before);
}

void ContactSet::collect(const ActiveMesh& mesh, const Field& nodes, const std::vector<double>& reach,
                         const std::vector<Reach>& touching) {
  samples_.clear();
  groups_.clear();
  packs_.clear();
  sampleObstacles(mesh, nodes, reach);
  for (const Reach& probe : touching) {
    beginGroup(obstacles_ + probe.probe);
    sampleProbe(mesh, nodes, reach, probe);
    endGroup();
  }
  // Each evaluation writes all entries.
  for (Field* field : {&gradient_, &change_}) field->resize(size());
  buildRows(mesh.nodes());
}

void ContactSet::beginGroup(int solid) { groups_.push_back({solid, size() / kPack, 0}); }

/// Completes a group; fills its last pack with samples that have no effect.
void ContactSet::endGroup() {
  Group& group = groups_.back();
  siftPoints(group.solid);
  while (size() % kPack != 0) samples_.push_back(ContactSample{nodePoint(0, 0.0), group.solid});
  group.end = size() / kPack;
  packs_.resize(group.end);
  packGroup(group);
}

namespace {

/// Line of points of a cell at one v along weft. It is straight, since cells are bilinear.
struct Row {
  Row(const Patch& patch, double v, const Field& x)
      : from((1 - v) * x[patch.nodes[0]] + v * x[patch.nodes[2]]),
        way((1 - v) * x[patch.nodes[1]] + v * x[patch.nodes[3]] - from) {}
  Vec3 at(double u) const { return from + u * way; }
  Vec3 from, way;
};

/// Range first..last of `count` points, evenly spread over a row, that lie within `reach` of a
/// point.
struct Window {
  Window(int count, const Row& row, const Vec3& point, double reach) {
    const Vec3 &from = row.from, &way = row.way;
    const double length = std::max(way.norm(), 1e-300), middle = (point - from).dot(way) / (length * length);
    const double aside = (point - from - middle * way).squaredNorm();
    const double half = std::sqrt(std::max(reach * reach - aside, 0.0)) / length;
    first = static_cast<int>(std::floor(count * std::clamp(middle - half, 0.0, 1.0)));
    last = aside > reach * reach ? first
                                 : static_cast<int>(std::ceil(count * std::clamp(middle + half, 0.0, 1.0)));
  }
  int first, last;
};

}  // namespace

void ContactSet::sampleObstacles(const ActiveMesh& mesh, const Field& nodes,
                                 const std::vector<double>& reach) {
  for (int solid = 0; solid < obstacles_; ++solid) {
    node_area_.assign(mesh.nodes(), 0.0);
    measure(solid, law_.range(), mesh, nodes, reach);
    beginGroup(solid);
    for (int k = 0; k < static_cast<int>(mesh.patches.size()); ++k) {
      const double near = patch_margins_[k];
      if (near < 0.0) continue;
      const Patch& patch = mesh.patches[k];
      const int parts = partsOf(patch);
      const double corner_area = 0.25 * patch.area / (parts * parts);
      for (const int corner : patch.nodes) node_area_[corner] += corner_area;
      if (parts > 1) sampleCell(patch, parts, nodes, near);
    }
    endGroup();
    beginGroup(solid);
    for (int n = 0; n < mesh.nodes(); ++n) {
      const double near = law_.range() + reach[n];
      if (node_area_[n] == 0.0 || node_gaps_[n] > near) continue;
      addPoint(nodePoint(n, node_area_[n]), nodes[n], near);
    }
    endGroup();
  }
}

/// Measures the distance of the nodes from a solid, and which patches may come within `range` of it
/// [m].
void ContactSet::measure(int solid, double range, const ActiveMesh& mesh, const Field& nodes,
                         const std::vector<double>& reach) {
  measureDistances(solids_[solid], nodes.size(), nodes, node_gaps_, node_normals_);
  const int patches = kPack * static_cast<int>(mesh.patch_corners.size());
  patch_margins_.resize(patches);
  const auto margins = [&](int begin, int end) {
    kernels().patchMargins(mesh.patch_corners.data() + begin / kPack, (end - begin) / kPack, range,
                           nodes.arrays(), reach.data(), node_gaps_.data(), node_normals_.arrays(),
                           patch_margins_.data() + begin);
  };
  team_.forRange(patches, margins);
}

/// Distances of points from a solid, and its normals there.
void ContactSet::measureDistances(const Solid& solid, int count, const Field& points,
                                  std::vector<double>& gaps, Field& normals) {
  gaps.resize(padded(count));
  normals.resize(count);
  const SolidLanes lanes = solid.lanes();
  const auto measure = [&](int begin, int end) {
    const ConstArrays at = points.arrays();
    const MutableArrays to = normals.arrays();
    kernels().solidDistances(lanes, end - begin, {at.x + begin, at.y + begin, at.z + begin},
                             gaps.data() + begin, {to.x + begin, to.y + begin, to.z + begin});
  };
  team_.forRange(count, measure);
}

/// Number of parts of a cell's side to be sampled. It is 1 if the obstacle presses evenly: one
/// normal at the corners, and gaps whose difference hardly changes the pressure. Otherwise it is
/// the number of finest cells, but no part is smaller than a share of the range. It is larger if a
/// sharp edge would cut deeper into these parts than that share.
int ContactSet::partsOf(const Patch& patch) const {
  constexpr double kSameNormal = 1e-3, kShareOfRange = 0.1, kMostParts = 4.0;
  // Largest differences over all pairs; with one corner as reference, mirrored cells would differ.
  double gaps = 0.0, turn = 0.0;
  for (int c = 1; c < 4; ++c) {
    for (int d = 0; d < c; ++d) {
      const int a = patch.nodes[c], b = patch.nodes[d];
      gaps = std::max(gaps, std::abs(node_gaps_[a] - node_gaps_[b]));
      turn = std::max(turn, (node_normals_[a] - node_normals_[b]).squaredNorm());
    }
  }
  turn = std::sqrt(turn);
  const bool uneven = gaps > kShareOfRange * law_.range() || turn > kSameNormal;
  const int span = patch.cell.span();
  const double smallest = kCut * law_.range(), side = span * std::max(grid_.dx, grid_.dy);
  const int finest = uneven ? std::min<int>(span, std::ceil(side / smallest)) : 1;
  return finest * static_cast<int>(std::clamp(std::ceil(chord(turn) / smallest), 1.0, kMostParts));
}

/// Samples a cell at (parts + 1) × (parts + 1) points without its corners; each stands for the area
/// around it within the cell.
void ContactSet::sampleCell(const Patch& patch, int parts, const Field& nodes, double margin) {
  for (int j = 0; j <= parts; ++j) {
    const double v = static_cast<double>(j) / parts;
    const Row row(patch, v, nodes);
    for (int i = 0; i <= parts; ++i) {
      if (i % parts == 0 && j % parts == 0) continue;
      const double u = static_cast<double>(i) / parts;
      const double share = (i % parts == 0 ? 0.5 : 1.0) * (j % parts == 0 ? 0.5 : 1.0);
      addPoint(surfacePoint(patch, u, v, share * patch.area / (parts * parts)), row.at(u), margin);
    }
  }
}

void ContactSet::sampleProbe(const ActiveMesh& mesh, const Field& nodes, const std::vector<double>& reach,
                             const Reach& touching) {
  const int index = obstacles_ + touching.probe;
  const Solid& solid = solids_[index];
  const double spacing = solid.halfWidth() / kProbeSpacing;
  measure(index, law_.range() + touching.distance, mesh, nodes, reach);
  for (int k = 0; k < static_cast<int>(mesh.patches.size()); ++k) {
    const double near = patch_margins_[k], from_centre = solid.extent() + near;
    if (near < 0.0) continue;
    const Patch& patch = mesh.patches[k];
    const auto count = [&](double length) {
      return std::max(1, static_cast<int>(std::ceil(length / spacing)));
    };
    const int columns = count(patch.cell.span() * grid_.dx), rows = count(patch.cell.span() * grid_.dy);
    const double area = patch.area / (static_cast<double>(columns) * rows);
    for (int j = 0; j < rows; ++j) {
      const double v = (j + 0.5) / rows;
      const Row row(patch, v, nodes);
      const Window window(columns, row, solid.position(), from_centre);
      for (int i = window.first; i < window.last; ++i) {
        const double u = (i + 0.5) / columns;
        addPoint(surfacePoint(patch, u, v, area), row.at(u), near);
      }
    }
  }
}

bool ContactSet::isClear(const ActiveMesh& mesh, const Field& nodes, int probe) {
  samples_.clear();
  still_.assign(mesh.nodes(), 0.0);
  sampleProbe(mesh, nodes, still_, {probe, 0.0});
  siftPoints(obstacles_ + probe);
  const bool clear = samples_.empty();
  samples_.clear();
  return clear;
}

SurfacePoint ContactSet::nodePoint(int node, double area) {
  return {{node, node, node, node}, {1.0, 0.0, 0.0, 0.0}, area};
}

/// @param u, v coordinates along warp and weft, 0..1
SurfacePoint ContactSet::surfacePoint(const Patch& patch, double u, double v, double area) {
  return {patch.nodes, {(1 - u) * (1 - v), u * (1 - v), (1 - u) * v, u * v}, area};
}

/// Offset of the gap for a sample that begins the step inside a solid. In an obstacle it was put
/// there; it counts as pressed, and less so the deeper it is. With the largest pressure a cloth
/// that begins in the middle of a ball would be blown up like a balloon and thrown out. A probe
/// came from outside, so its samples are inside only under load and must not yield step by step.
double ContactSet::raise(int solid, double gap) const {
  constexpr double kGentle = 0.2;  // smallest u that counts: p0/20, 500 Pa
  if (isProbe(solid)) return std::max(0.0, -law_.range() - gap);
  if (!(gap < 0.0)) return 0.0;
  const double firm = law_.range() - law_.firmGap();
  const double pressed = std::max(std::min(1.0, law_.range() / -gap) * firm, kGentle * law_.range());
  return law_.range() - pressed - gap;
}

/// Adds a candidate for a sample. @param margin largest gap at which it counts [m]
void ContactSet::addPoint(const SurfacePoint& point, const Vec3& place, double margin) {
  const int index = static_cast<int>(points_.size());
  if (index >= places_.size()) places_.resize(index + kChunk);
  places_.set(index, place);
  margins_.push_back(margin);
  points_.push_back(point);
}

/// Turns the candidates that are near at the start of the step into samples. Touching samples come
/// first, so that packs of the others can be skipped.
void ContactSet::siftPoints(int solid) {
  const Solid &now = solids_[solid], &then = before_[solid];
  const bool still = now.position() == then.position() && now.rotation() == then.rotation();
  const int count = static_cast<int>(points_.size());
  measureDistances(now, count, places_, sample_gaps_[0], sample_normals_[0]);
  if (!still) measureDistances(then, count, places_, sample_gaps_[1], sample_normals_[1]);
  near_.clear();
  for (int k = 0; k < count; ++k) {
    if (!(sample_gaps_[0][k] > margins_[k])) near_.push_back(k);
  }
  const int samples = static_cast<int>(near_.size());
  if (static_cast<int>(started_.size()) < samples) started_.resize(samples);
  const auto start = [&](int begin, int end) {
    for (int s = begin; s < end; ++s) {
      const int k = near_[s];
      const Distance at_end{sample_gaps_[0][k], sample_normals_[0][k]};
      const Distance at_start = still ? at_end : Distance{sample_gaps_[1][k], sample_normals_[1][k]};
      started_[s] = started(points_[k], solid, places_[k], at_end, at_start, still);
    }
  };
  team_.forRange(samples, start, kStart);
  for (const bool apart : {false, true}) {
    for (int s = 0; s < samples; ++s) {
      if ((started_[s].clearance > 0.0) == apart) samples_.push_back(started_[s]);
    }
  }
  margins_.clear();
  points_.clear();
}

/// Starts a sample. If a moving solid touches it only at the end of the step, it has no friction
/// yet.
/// @param now, then distance from the solid at the end and at the start of the step
ContactSample ContactSet::started(const SurfacePoint& point, int index, const Vec3& place,
                                  const Distance& now, const Distance& then, bool still) const {
  const Solid &solid = solids_[index], &before = before_[index];
  ContactSample sample{point, index};
  sample.raised = raise(index, then.value);
  // Ejected cloth has no friction, which would hold it inside.
  const double friction = !isProbe(index) && sample.raised > 0.0 ? 0.0 : solid.friction();
  sample.friction_force = friction * point.area * law_(then.value + sample.raised).pressure;
  Vec3 carried = place;
  sample.start_normal = then.normal;
  if (!still) {
    const Eigen::Matrix3d turn = solid.rotation() * before.rotation().transpose();
    carried = solid.position() + turn * (place - before.position());
    sample.start_normal = turn * then.normal;
  }
  sample.start = carried - origin(index);
  sample.carry = carried - place;
  sample.clearance = now.value - law_.range() - sample.carry.norm();
  return sample;
}

void ContactSet::buildRows(int nodes) {
  rows_.assign(nodes + 1, 0);
  const auto visit = [&](const auto& put) {
    for (int k = 0; k < size(); ++k) {
      for (int c = 0; c < 4; ++c) {
        if (samples_[k].area > 0.0 && samples_[k].weights[c] > 0.0)
          put(samples_[k].nodes[c], Entry{k, samples_[k].weights[c]});
      }
    }
  };
  visit([&](int node, const Entry&) { ++rows_[node + 1]; });
  for (int n = 0; n < nodes; ++n) rows_[n + 1] += rows_[n];
  entries_.resize(rows_[nodes]);
  visit([&](int node, const Entry& entry) { entries_[rows_[node]++] = entry; });
  for (int n = nodes; n > 0; --n) rows_[n] = rows_[n - 1];
  rows_[0] = 0;
}

}  // namespace haptic_cloth
