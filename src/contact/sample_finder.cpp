#include "contact/sample_finder.h"

#include <algorithm>
#include <cmath>
#include <utility>

#include "contact/friction_law.h"
#include "shape/solid_lanes.h"
#include "simd/kernels.h"

namespace haptic_cloth {
namespace {

constexpr int kChunk = 512;         // growth of the arrays of points [points]
constexpr double kCut = 0.5;        // length of short parts, and how deep a round solid may cut [ranges]
constexpr double kMostParts = 4.0;  // of a finest cell on a round solid, at most
constexpr double kFlat = 0.1;       // rise of the arc of an obstacle over a cell that counts as flat [ranges]
constexpr double kBeside = 2.0;     // distance from an edge where cloth may press on it [ranges]
constexpr double kPile = 10.0;      // height of layers that bend like the obstacle below them [ranges]
constexpr double kSharp = 0.3;      // turn of a normal that tells of a sharp edge [rad]
constexpr double kMostTurn = 2.0;   // difference of two unit normals, at most
constexpr double kMostSlanting = 12.0;  // parts of a finest cell across slanting edges, at most
constexpr double kSlanting = 3.0;       // length of parts across slanting edges over that across others
// Ends of the sides of a cell along warp and weft.
constexpr std::array<std::array<std::pair<int, int>, 2>, 2> kSides{{{{{0, 1}, {2, 3}}}, {{{0, 2}, {1, 3}}}}};
constexpr double kStart = 3e-8;  // time that the start of a sample takes, about [s]

/// Largest distance of the samples of a probe: a third of half its width, and of the radius on which a ball
/// of that size that touches flat cloth is nearer to it than the range [m].
double probeSpacing(const Solid& probe, double range) {
  const double width = probe.halfWidth();
  return std::min(width, std::sqrt(2.0 * width * range)) / 3.0;
}

/// Share of a way that another way makes [-]; 1 of none.
double shareAlong(const Vec3& way, const Vec3& whole) {
  const double squared = whole.squaredNorm();
  return squared > 0.0 ? way.dot(whole) / squared : 1.0;
}

/// Line of points of a cell at one v along weft. It is straight, since cells are bilinear.
struct Row {
  Row(const Patch& patch, double v, const Field& x)
      : from((1 - v) * x[patch.nodes[0]] + v * x[patch.nodes[2]]),
        span((1 - v) * x[patch.nodes[1]] + v * x[patch.nodes[3]] - from) {}
  Vec3 at(double u) const { return from + u * span; }
  Vec3 from, span;
};

/// Range of a row, as shares of its length, that lies within `reach` of a point; empty if none does.
struct Window {
  Window(const Row& row, const Vec3& point, double reach) {
    const Vec3 &from = row.from, &span = row.span;
    const double length = std::max(span.norm(), 1e-300),
                 middle = (point - from).dot(span) / (length * length);
    const double aside = (point - from - middle * span).squaredNorm();
    if (aside > reach * reach) return;
    const double half = std::sqrt(reach * reach - aside) / length;
    first = middle - half;
    last = middle + half;
  }
  double first = 1.0, last = 0.0;
};

/// @param u, v coordinates along warp and weft, 0..1
SurfacePoint surfacePoint(const Patch& patch, double u, double v, double area) {
  const Cell& cell = patch.cell;
  return {patch.nodes,
          {(1 - u) * (1 - v), u * (1 - v), (1 - u) * v, u * v},
          area,
          {cell.i + u * cell.span(), cell.j + v * cell.span()}};
}

}  // namespace

SampleFinder::SampleFinder(const Grid& grid, const SolidSet& solids, const ContactLaw& law,
                           const FrictionMemory& memory, Team& team)
    : grid_(grid), solids_(solids), law_(law), memory_(memory), team_(team) {
  const int samples = capacity();
  probes_.reserve(solids.size());
  is_let_out_.reserve(grid.particles());
  started_.reserve(samples);
  near_.reserve(samples);
  near_probe_.reserve(grid.particles());
  dented_.reserve(grid.cells());
  for (auto* list : {&node_area_, &still_, &edge_turns_[kWarp], &edge_turns_[kWeft]})
    list->reserve(grid.particles());
  double shortest = kCut * law_.range();
  for (int k = solids_.obstacles(); k < solids_.size(); ++k)
    shortest = std::min(shortest, probeSpacing(solids_[k], law_.range()));
  const int span = 1 << grid_.levels, rest = 2 * span + 4;  // rest: parts beside an edge, and rounding
  const int most = static_cast<int>(span * longestSide() / shortest) + rest;
  for (auto& lines : lines_) lines.reserve(most);
  patch_margins_.reserve(padded(grid.cells()));
  at_nodes_.gaps.reserve(padded(grid.particles()));
  at_nodes_.normals.reserve(grid.particles());
  margins_.reserve(samples);
  points_.reserve(samples);
  places_.reserve(samples + kChunk);
  for (Distances* distances : {&now_, &then_}) {
    distances->gaps.reserve(padded(samples));
    distances->normals.reserve(samples);
  }
}

int SampleFinder::capacity() const {
  const int particles = grid_.particles(), solids = solids_.size();
  const double spacing = longestSide();
  bool fine = chord(2.0) <= kCut * law_.range();
  for (int k = solids_.obstacles(); k < solids; ++k) {
    fine = fine && spacing <= probeSpacing(solids_[k], law_.range());
  }
  const int places = fine ? (particles + particles / 2) * solids : 4 * particles * (solids + 1);
  return places + 2 * kPack * solids;
}

void SampleFinder::findProbes(const ActiveMesh& mesh, const Field& nodes, const std::vector<double>& reach,
                              const Field& motion, const std::vector<Reach>& touching, SampleList& samples) {
  samples.clear();
  probes_.clear();
  for (const Reach& probe : touching) {
    const int solid = solids_.indexOf(probe.probe);
    addProbePoints(mesh, nodes, reach, probe);
    if (addGroup(solid, motion, samples)) probes_.push_back(solid);
  }
  near_probe_.assign(mesh.nodes(), 0);
  dented_.assign(mesh.patches.size(), 0);
  if (probes_.empty()) return;
  for (int n = 0; n < mesh.nodes(); ++n) near_probe_[n] = isNearProbe(nodes[n]) ? 1 : 0;
  for (std::size_t k = 0; k < mesh.patches.size(); ++k)
    dented_[k] = layersMayBeDented(mesh.patches[k], nodes) ? 1 : 0;
}

/// Tells whether a probe may dent layers that press on each other in a finest cell, see dented(). They press
/// before the probe comes. So they have to lie flat there: over a curve even layers do not press evenly on
/// nodes and middles.
bool SampleFinder::layersMayBeDented(const Patch& patch, const Field& nodes) const {
  const auto isOverCurve = [&](int n) {
    const double near = kPile * law_.range() + longestSide();
    for (int k = 0; k < solids_.obstacles(); ++k) {
      const Solid& solid = solids_[k];
      if (solid.edgeDistance(nodes[n]) < near) return true;
      if (!isFlat(solid) && solid.distance(nodes[n]).value < near) return true;
    }
    return false;
  };
  return isFinestNearProbe(patch) && std::none_of(patch.nodes.begin(), patch.nodes.end(), isOverCurve);
}

bool SampleFinder::isFinestNearProbe(const Patch& patch) const {
  return patch.cell.span() == 1 &&
         std::any_of(patch.nodes.begin(), patch.nodes.end(), [&](int n) { return near_probe_[n] != 0; });
}

/// Tells whether an obstacle counts as flat over the diagonal of a finest cell.
bool SampleFinder::isFlat(const Solid& solid) const {
  const double bulge = (grid_.dx * grid_.dx + grid_.dy * grid_.dy) / 8.0 * solid.curvature();
  return bulge <= kFlat * law_.range();
}

void SampleFinder::findObstacles(const ActiveMesh& mesh, const Field& nodes, const std::vector<double>& reach,
                                 const Field& motion, SampleList& samples) {
  is_let_out_.assign(mesh.nodes(), 0);
  for (const int particle : let_out_) {
    if (mesh.node[particle] >= 0) is_let_out_[mesh.node[particle]] = 1;
  }
  const Ball ball = ballAround(nodes, reach);
  for (int solid = 0; solid < solids_.obstacles(); ++solid) {
    if (solids_[solid].distance(ball.centre).value > ball.radius + law_.range()) continue;
    const Solid sharp = solids_[solid].sharp();
    measure(sharp, law_.range(), mesh, nodes, reach);
    findEdges(sharp, mesh, nodes);
    addCells(solids_[solid], mesh, nodes);
    addGroup(solid, motion, samples);
    addNodes(mesh, nodes, reach);
    addGroup(solid, motion, samples);
  }
  listLetOut(mesh, samples);
}

std::optional<Vec3> SampleFinder::wayOut(const ActiveMesh& mesh, const Field& nodes, int probe) {
  still_.assign(mesh.nodes(), 0.0);
  addProbePoints(mesh, nodes, still_, {probe, 0.0});
  selectNear(solids_.indexOf(probe));
  Vec3 out = Vec3::Zero();
  for (const int k : near_) out -= points_[k].area * (law_.range() - now_.gaps[k]) * now_[k].normal;
  clearPoints();
  if (near_.empty()) return std::nullopt;
  return out.stableNormalized();
}

/// The ball around the box around the nodes.
SampleFinder::Ball SampleFinder::ballAround(const Field& nodes, const std::vector<double>& reach) {
  Vec3 low, high;
  for (int c = 0; c < 3; ++c) {
    const Eigen::Map<const Eigen::ArrayXd> values(nodes.coordinate(c).data(), nodes.size());
    low[c] = values.minCoeff();
    high[c] = values.maxCoeff();
  }
  const Eigen::Map<const Eigen::ArrayXd> reaches(reach.data(), nodes.size());
  return {0.5 * (low + high), 0.5 * (high - low).norm() + reaches.maxCoeff()};
}

/// Adds points of the cells on which an obstacle does not press evenly. The other cells leave their
/// area to their nodes.
void SampleFinder::addCells(const Solid& solid, const ActiveMesh& mesh, const Field& nodes) {
  node_area_.assign(mesh.nodes(), 0.0);
  for (int k = 0; k < static_cast<int>(mesh.patches.size()); ++k) {
    const double near = patch_margins_[k];
    if (near < 0.0) continue;
    const Patch& patch = mesh.patches[k];
    const bool may_be_dented = mayBeDented(solid, patch, nodes);
    if (may_be_dented && mayTouchEdge(solid, patch, nodes)) {
      divideEvenly();
      addLines(patch, solid, nodes, near);
      continue;
    }
    if (divideAtEdge(solid, patch, nodes)) {
      addLines(patch, solid, nodes, near);
      continue;
    }
    const int parts = partsOf(patch);
    const bool dented = parts == 1 && may_be_dented;
    const double corner_area = patch.area / (dented ? 36 : 4 * parts * parts);
    for (const int corner : patch.nodes) node_area_[corner] += corner_area;
    if (parts > 1) addCorners(patch, parts, nodes, near);
    if (dented) addMiddlesOfCell(patch, nodes, near);
  }
}

/// Tells whether a probe may dent a finest cell. It must not depend on the pressure: if the weights changed
/// with it, a hand could gain energy on a closed path. They may change away from the dent, where the pressure
/// is even. It is not on a round obstacle, which is nearer to the middle of a wide cell than to its corners.
/// Cloth that is ejected needs its nodes as samples.
bool SampleFinder::mayBeDented(const Solid& solid, const Patch& patch, const Field& nodes) const {
  const auto was_put_inside = [&](int n) {
    if (!(at_nodes_.gaps[n] < 0.0)) return false;
    const double gap = solid.distance(nodes[n]).value;
    return gap < 0.0 && (is_let_out_[n] || !isPressedIn(nodes[n], gap));
  };
  return isFlat(solid) && isFinestNearProbe(patch) &&
         std::none_of(patch.nodes.begin(), patch.nodes.end(), was_put_inside);
}

/// Tells whether a probe that touches is so near that it may press cloth here into an obstacle.
bool SampleFinder::isNearProbe(const Vec3& place) const {
  const double near = law_.range() + longestSide();
  return std::any_of(probes_.begin(), probes_.end(), [&](int index) {
    const Solid& probe = solids_[index];
    return (place - probe.position()).norm() < probe.extent() + near && probe.distance(place).value < near;
  });
}

/// Tells whether a load may keep cloth at a gap below zero, up to the range deep: it was not put there.
bool SampleFinder::isPressedIn(const Vec3& place, double gap) const {
  return gap > -law_.range() && isNearProbe(place);
}

/// Lists what obstacles let out in this step. It stays so until it has left them: pressed in, it would be
/// thrown out.
void SampleFinder::listLetOut(const ActiveMesh& mesh, const SampleList& samples) {
  let_out_.clear();
  is_let_out_.assign(mesh.nodes(), 0);
  for (const ContactSample& sample : samples) {
    if (!sample.isLetOut()) continue;
    for (int c = 0; c < 4; ++c) {
      const int node = sample.nodes[c];
      if (sample.weights[c] == 0.0 || is_let_out_[node]) continue;
      is_let_out_[node] = 1;
      let_out_.push_back(mesh.particle[node]);
    }
  }
}

void SampleFinder::serialize(Archive& archive) {
  archive.length("let_out", let_out_, grid_.particles());
  archive.within("let_out_particle", let_out_, 0, grid_.particles() - 1);
}

/// Adds the middles of a cell and of its sides, with their weights by Simpson's rule. Corners alone would
/// carry up to four times the pressure in a dent, which grows fast with depth.
void SampleFinder::addMiddlesOfCell(const Patch& patch, const Field& nodes, double margin) {
  for (int j = 0; j <= 2; ++j) {
    const Row row(patch, 0.5 * j, nodes);
    for (int i = 0; i <= 2; ++i) {
      if (i != 1 && j != 1) continue;
      const double weight = (i == 1 ? 4.0 : 1.0) * (j == 1 ? 4.0 : 1.0) / 36.0;
      addPoint(surfacePoint(patch, 0.5 * i, 0.5 * j, weight * patch.area), row.at(0.5 * i), margin);
    }
  }
}

/// Adds the nodes with the area that addCells() left to them.
void SampleFinder::addNodes(const ActiveMesh& mesh, const Field& nodes, const std::vector<double>& reach) {
  for (int n = 0; n < mesh.nodes(); ++n) {
    const double near = law_.range() + reach[n];
    if (node_area_[n] == 0.0 || at_nodes_.gaps[n] > near) continue;
    const int particle = mesh.particle[n];
    const FlatPoint flat{double(grid_.column(particle)), double(grid_.row(particle))};
    addPoint(SurfacePoint::atNode(n, node_area_[n], flat), nodes[n], near);
  }
}

/// Adds the corners of parts × parts equal parts of a cell but its own; each stands for the area around it
/// within the cell.
void SampleFinder::addCorners(const Patch& patch, int parts, const Field& nodes, double margin) {
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

/// Adds the points of a cell where lines_ cross, if they may be near a solid.
void SampleFinder::addLines(const Patch& patch, const Solid& solid, const Field& nodes, double margin) {
  for (const auto& [v, height] : lines_[kWeft]) {
    const Row row(patch, v, nodes);
    const Window window(row, solid.position(), solid.extent() + margin);
    for (const auto& [u, width] : lines_[kWarp]) {
      if (u < window.first || u > window.last) continue;
      addPoint(surfacePoint(patch, u, v, width * height * patch.area), row.at(u), margin);
    }
  }
}

/// Lays lines through the middles of equal parts of a cell's sides along one direction, from one share of
/// their length to another.
void SampleFinder::addMiddles(int direction, int parts, double from, double to) {
  const double width = (to - from) / parts;
  for (int k = 0; k < parts; ++k) lines_[direction].push_back({from + (k + 0.5) * width, width});
}

/// Lays lines through the ends of equal parts of a cell's sides along one direction.
void SampleFinder::addEnds(int direction, int parts) {
  for (int k = 0; k <= parts; ++k)
    lines_[direction].push_back({double(k) / parts, (k % parts == 0 ? 0.5 : 1.0) / parts});
}

/// Finds the nodes that are nearer to a sharp edge than the range, and how far the solid's normal turns there
/// along warp and weft.
void SampleFinder::findEdges(const Solid& solid, const ActiveMesh& mesh, const Field& nodes) {
  for (auto& turns : edge_turns_) turns.assign(mesh.nodes(), 0.0);
  for (int k = 0; k < static_cast<int>(mesh.patches.size()); ++k) {
    if (patch_margins_[k] < 0.0) continue;
    const Patch& patch = mesh.patches[k];
    for (const int direction : {kWarp, kWeft}) {
      const double turn = edgeTurn(solid, patch, direction);
      if (turn == 0.0) continue;
      for (const auto& [c, d] : kSides[direction]) {
        noteEdge(solid, nodes, patch.nodes[c], patch.nodes[d], turn, edge_turns_[direction]);
        noteEdge(solid, nodes, patch.nodes[d], patch.nodes[c], turn, edge_turns_[direction]);
      }
    }
  }
}

/// Notes a turn at a node if the normal differs as far away as the range, towards another node.
void SampleFinder::noteEdge(const Solid& solid, const Field& nodes, int node, int towards, double turn,
                            std::vector<double>& turns) const {
  const Vec3 way = nodes[towards] - nodes[node];
  const Vec3 there = nodes[node] + std::min(1.0, law_.range() / way.norm()) * way;
  const Vec3 change = solid.distance(there).normal - at_nodes_.normals[node];
  if (change.norm() > kSharp) turns[node] = std::max(turns[node], turn);
}

/// Turn of a solid's normal over a sharp edge, along two sides of a cell; zero without an edge [rad]. A round
/// face explains a turn of its curvature times the length.
double SampleFinder::edgeTurn(const Solid& solid, const Patch& patch, int direction) const {
  const double least = kSharp + patch.cell.span() * spacing(direction) * solid.faceCurvature();
  if (least > kMostTurn) return 0.0;
  double turn = 0.0;
  for (const auto& [c, d] : kSides[direction]) turn = std::max(turn, normalTurn(patch, c, d));
  return turn > least ? turn : 0.0;
}

/// Difference of a solid's normals at two corners of a cell [rad].
double SampleFinder::normalTurn(const Patch& patch, int c, int d) const {
  return (at_nodes_.normals[patch.nodes[c]] - at_nodes_.normals[patch.nodes[d]]).norm();
}

/// Divides a cell near a sharp edge into parts. Cloth presses on the edge with a strip about as wide as the
/// range, wherever its nodes lie. There the parts are a share of the range long across the edge; elsewhere
/// they are as long as finest cells.
/// @return whether the cell is near an edge
bool SampleFinder::divideAtEdge(const Solid& solid, const Patch& patch, const Field& nodes) {
  std::array<double, 2> within, turn;  // over an edge in the cell, and near it
  for (const int direction : {kWarp, kWeft}) {
    turn[direction] = within[direction] = edgeTurn(solid, patch, direction);
    for (const int corner : patch.nodes)
      turn[direction] = std::max(turn[direction], edge_turns_[direction][corner]);
  }
  const bool corner = mayTouchCorner(solid, patch, nodes);
  if (!corner && turn[kWarp] == 0.0 && turn[kWeft] == 0.0) return false;
  // Across a slanting edge, and at a corner of the solid, both rows and columns are dense.
  const bool slants = corner || 2.0 * std::min(turn[kWarp], turn[kWeft]) > std::max(turn[kWarp], turn[kWeft]);
  const int span = patch.cell.span();
  for (const int direction : {kWarp, kWeft}) {
    lines_[direction].clear();
    if (!slants && turn[direction] < turn[1 - direction]) {
      const int parts = span * partsAlong(solid, direction);
      if (isTilted(patch, direction)) {
        addEnds(direction, 2 * parts);
      } else {
        addMiddles(direction, parts, 0.0, 1.0);
      }
      continue;
    }
    const double across = std::ceil(span * spacing(direction) / (kCut * law_.range()));
    const double slanting = std::min(std::ceil(across / kSlanting), span * kMostSlanting);
    const double parts = std::max<double>(span, slants ? slanting : across);
    const auto [from, to] = strip(patch, direction, within[direction] > 0.0, nodes);
    const double first = std::floor(from * parts), last = std::ceil(to * parts);
    const auto coarse = [&](double count) { return static_cast<int>(std::ceil(count * span / parts)); };
    addMiddles(direction, coarse(first), 0.0, first / parts);
    addMiddles(direction, static_cast<int>(last - first), first / parts, last / parts);
    addMiddles(direction, coarse(parts - last), last / parts, 1.0);
  }
  return true;
}

/// Divides a finest cell that a probe may dent over an edge into parts as long as the range. They must not
/// follow the pressure, see mayBeDented(); those of divideAtEdge() do.
void SampleFinder::divideEvenly() {
  for (const int direction : {kWarp, kWeft}) {
    lines_[direction].clear();
    const double parts = std::min(std::ceil(spacing(direction) / law_.range()), kMostSlanting);
    addMiddles(direction, static_cast<int>(parts), 0.0, 1.0);
  }
}

/// Tells whether an edge of a solid may press on a cell.
bool SampleFinder::mayTouchEdge(const Solid& solid, const Patch& patch, const Field& nodes) const {
  const Ball ball = ballAround(patch, nodes);
  return solid.edgeDistance(ball.centre) < ball.radius + kBeside * law_.range();
}

/// Tells whether a corner of a solid may press on a cell. The normals at the cell's own corners need not
/// tell: one of the faces that meet there may be nearest to none of them.
bool SampleFinder::mayTouchCorner(const Solid& solid, const Patch& patch, const Field& nodes) const {
  if (!solid.hasCorners()) return false;
  const Ball ball = ballAround(patch, nodes);
  return solid.cornerDistance(ball.centre) < ball.radius + law_.range();
}

/// A ball around the corners of a cell.
SampleFinder::Ball SampleFinder::ballAround(const Patch& patch, const Field& nodes) {
  Ball ball{Vec3::Zero(), 0.0};
  for (const int corner : patch.nodes) ball.centre += 0.25 * nodes[corner];
  for (const int corner : patch.nodes)
    ball.radius = std::max(ball.radius, (nodes[corner] - ball.centre).norm());
  return ball;
}

/// Number of parts of a finest cell along an edge that is as round as the faces, so that it cuts no deeper
/// into them than a share of the range.
int SampleFinder::partsAlong(const Solid& solid, int direction) const {
  const double length = spacing(direction), cut = length * length * solid.faceCurvature() / 8.0;
  return static_cast<int>(std::clamp(std::ceil(std::sqrt(cut / (kCut * law_.range()))), 1.0, kMostParts));
}

/// Tells whether a cell rises along an edge, so that the ends of a finest cell are much nearer to the solid
/// than its middle: a fold that crosses the edge touches it there.
bool SampleFinder::isTilted(const Patch& patch, int direction) const {
  double rises = 0.0;
  for (const auto& [c, d] : kSides[direction])
    rises = std::max(rises, std::abs(at_nodes_.gaps[patch.nodes[c]] - at_nodes_.gaps[patch.nodes[d]]));
  return 0.5 * rises / patch.cell.span() > kCut * law_.range();
}

/// Part of a cell that may press on a sharp edge, as shares of its length along warp or weft. It is known
/// where the sides meet the faces that their ends are nearest to; the edge is between. An edge that slants
/// may leave the cell over one of the other sides, at share 0 or 1.
/// @param within the edge is in the cell, not only near it
std::array<double, 2> SampleFinder::strip(const Patch& patch, int direction, bool within,
                                          const Field& nodes) const {
  std::array<bool, 2> leaves;
  for (const int end : {0, 1}) {
    const auto& [c, d] = kSides[1 - direction][end];
    leaves[end] = normalTurn(patch, c, d) > kSharp;
  }
  double from = 1.0, to = 0.0;
  for (const auto& [c, d] : kSides[direction]) {
    const int a = patch.nodes[c], b = patch.nodes[d];
    const Vec3 way = nodes[b] - nodes[a];
    const double beside = kBeside * law_.range() / std::max(way.norm(), 1e-300);
    const auto include = [&](double place) {
      from = std::min(from, std::clamp(place - beside, 0.0, 1.0));
      to = std::max(to, std::clamp(place + beside, 0.0, 1.0));
    };
    if (edge_turns_[direction][a] > 0.0 || leaves[0]) include(0.0);
    if (edge_turns_[direction][b] > 0.0 || leaves[1]) include(1.0);
    const double sinks = -at_nodes_.normals[a].dot(way), rises = at_nodes_.normals[b].dot(way);
    if (within && sinks > 0.0) include(at_nodes_.gaps[a] / sinks);
    if (within && rises > 0.0) include(1.0 - at_nodes_.gaps[b] / rises);
  }
  if (from >= to) return {0.0, 1.0};
  return {from, to};
}

/// Number of parts of a cell's side to be sampled. It is 1 if the obstacle presses evenly: one
/// normal at the corners, and gaps whose difference hardly changes the pressure. Otherwise it is
/// the number of finest cells, but no part is smaller than a share of the range. It is larger if a
/// round solid would cut deeper into these parts than that share.
int SampleFinder::partsOf(const Patch& patch) const {
  constexpr double kSameNormal = 1e-3, kShareOfRange = 0.1;
  // Largest differences over all pairs; with one corner as reference, mirrored cells would differ.
  double gaps = 0.0, turn = 0.0;
  for (int c = 1; c < 4; ++c) {
    for (int d = 0; d < c; ++d) {
      gaps = std::max(gaps, std::abs(at_nodes_.gaps[patch.nodes[c]] - at_nodes_.gaps[patch.nodes[d]]));
      turn = std::max(turn, normalTurn(patch, c, d));
    }
  }
  const bool uneven = gaps > kShareOfRange * law_.range() || turn > kSameNormal;
  const int span = patch.cell.span();
  const double smallest = kCut * law_.range(), side = span * longestSide();
  const int finest = uneven ? std::min<int>(span, std::ceil(side / smallest)) : 1;
  return finest * static_cast<int>(std::clamp(std::ceil(chord(turn) / smallest), 1.0, kMostParts));
}

/// Adds points of the cells near a probe, in rows and columns that are dense enough for it.
void SampleFinder::addProbePoints(const ActiveMesh& mesh, const Field& nodes,
                                  const std::vector<double>& reach, const Reach& touching) {
  const Solid& solid = solids_[solids_.indexOf(touching.probe)];
  measure(solid, law_.range() + touching.distance, mesh, nodes, reach);
  for (int k = 0; k < static_cast<int>(mesh.patches.size()); ++k) {
    const double near = patch_margins_[k];
    if (near < 0.0) continue;
    const Patch& patch = mesh.patches[k];
    for (const int direction : {kWarp, kWeft}) {
      const double parts =
          std::ceil(patch.cell.span() * spacing(direction) / probeSpacing(solid, law_.range()));
      lines_[direction].clear();
      addMiddles(direction, std::max(1, static_cast<int>(parts)), 0.0, 1.0);
    }
    addLines(patch, solid, nodes, near);
  }
}

/// Measures the distance of the nodes from a solid, and which patches may come within `range` of it [m].
/// @param solid has sharp edges: over rounded ones the normals at the nodes would not tell where an edge is
void SampleFinder::measure(const Solid& solid, double range, const ActiveMesh& mesh, const Field& nodes,
                           const std::vector<double>& reach) {
  measureDistances(solid, nodes.size(), nodes, at_nodes_);
  const int patches = kPack * static_cast<int>(mesh.patch_corners.size());
  patch_margins_.resize(patches);
  const auto margins = [&](int begin, int end) {
    kernels().patchMargins(mesh.patch_corners.data() + begin / kPack, (end - begin) / kPack, range,
                           nodes.arrays(), reach.data(), at_nodes_.gaps.data(), at_nodes_.normals.arrays(),
                           patch_margins_.data() + begin);
  };
  team_.forRange(patches, margins);
}

void SampleFinder::measureDistances(const Solid& solid, int count, const Field& points,
                                    Distances& distances) {
  distances.gaps.resize(padded(count));
  distances.normals.resize(count);
  const SolidLanes lanes = solid.lanes();
  const auto measure = [&](int begin, int end) {
    const ConstArrays at = points.arrays();
    const MutableArrays to = distances.normals.arrays();
    kernels().solidDistances(lanes, end - begin, {at.x + begin, at.y + begin, at.z + begin},
                             distances.gaps.data() + begin, {to.x + begin, to.y + begin, to.z + begin});
  };
  team_.forRange(count, measure);
}

/// Adds a candidate for a sample. @param margin largest gap at which it counts [m]
void SampleFinder::addPoint(const SurfacePoint& point, const Vec3& place, double margin) {
  const int index = static_cast<int>(points_.size());
  if (index >= places_.size()) places_.resize(index + kChunk);
  places_.set(index, place);
  margins_.push_back(margin);
  points_.push_back(point);
}

/// Selects the candidates that are near a solid at the start of the step.
void SampleFinder::selectNear(int solid) {
  const bool still = solids_.isStill(solid);
  const int count = static_cast<int>(points_.size());
  measureDistances(solids_[solid], count, places_, now_);
  if (!still) measureDistances(solids_.before(solid), count, places_, then_);
  near_.clear();
  for (int k = 0; k < count; ++k) {
    if (!(now_.gaps[k] > margins_[k])) near_.push_back(k);
  }
}

void SampleFinder::clearPoints() {
  margins_.clear();
  points_.clear();
}

/// Adds the candidates that are near a solid. Touching samples come first, so that packs of the
/// others can be skipped. @return whether any touches
bool SampleFinder::addGroup(int solid, const Field& motion, SampleList& samples) {
  selectNear(solid);
  const int count = static_cast<int>(near_.size());
  if (static_cast<int>(started_.size()) < count) started_.resize(count);
  const Eigen::AngleAxisd turn = solids_.turnInStep(solid);
  const SolidStep step{solids_.isStill(solid), turn, turn.toRotationMatrix()};
  const auto start = [&](int begin, int end) {
    for (int s = begin; s < end; ++s) started_[s] = startSample(near_[s], solid, step, motion);
  };
  team_.forRange(count, start, kStart);
  clearPoints();
  samples.beginGroup(solid);
  const int first = samples.size();
  for (const bool apart : {false, true}) {
    for (std::size_t s = 0; s < near_.size(); ++s) {
      if ((started_[s].clearance > 0.0) == apart) samples.add(started_[s]);
    }
  }
  const bool touches = samples.size() > first && !(samples[first].clearance > 0.0);
  samples.endGroup();
  return touches;
}

/// Tells whether a point moves with a node that is let out.
bool SampleFinder::touchesLetOut(const SurfacePoint& point) const {
  for (int c = 0; c < 4; ++c) {
    if (point.weights[c] > 0.0 && is_let_out_[point.nodes[c]]) return true;
  }
  return false;
}

/// Slip over the smoothing length for the friction that is remembered, before the solid turns.
Vec3 SampleFinder::elasticSlip(const ContactSample& sample) const {
  return slipUnder(sample.area / sample.friction_force * memory_.find(sample.solid, sample.flat));
}

/// Starts a sample. If a moving solid touches it only at the end of the step, it has no friction
/// yet.
ContactSample SampleFinder::startSample(int point, int index, const SolidStep& step,
                                        const Field& motion) const {
  const Solid &solid = solids_[index], &before = solids_.before(index);
  const Vec3 place = places_[point];
  const Distance then = step.still ? now_[point] : then_[point];
  ContactSample sample{points_[point], index};
  // A probe came from outside, so what is inside it is under load.
  sample.pressed_in = solids_.isProbe(index) ||
                      (then.value < 0.0 && !touchesLetOut(sample) && isPressedIn(place, then.value));
  sample.gap_offset = law_.gapOffset(then.value, sample.pressed_in);
  // Ejected cloth has no friction, which would hold it inside.
  const double friction = sample.isLetOut() ? 0.0 : solid.friction();
  sample.friction_force = friction * sample.area * law_(then.value + sample.gap_offset).pressure;
  Vec3 carried = place;
  sample.start_normal = then.normal;
  if (sample.friction_force > 0.0) sample.elastic_slip = elasticSlip(sample);
  if (!step.still) {
    const Vec3 arm = place - before.position(), turned = step.rotation * arm;
    carried = solid.position() + turned;
    sample.turn_share = shareAlong(sample.of(motion) - solids_.way(index), turned - arm);
    // Where cloth slips in place on a roller the normal stays, or friction would press the cloth on.
    sample.start_normal = partOf(step.turn, std::clamp(sample.turn_share, 0.0, 1.0)) * then.normal;
    sample.elastic_slip = step.rotation * sample.elastic_slip;
  }
  sample.elastic_slip -= sample.elastic_slip.dot(sample.start_normal) * sample.start_normal;
  sample.start = carried - solids_.origin(index);
  sample.carry = carried - place;
  sample.clearance = now_.gaps[point] - law_.range() - sample.carry.norm();
  return sample;
}

}  // namespace haptic_cloth
