#include "contact/edge_division.h"

#include <algorithm>
#include <cmath>
#include <utility>

namespace haptic_cloth {
namespace {

constexpr double kBeside = 2.0;         // distance from an edge where cloth may press on it [ranges]
constexpr double kSharp = 0.3;          // turn of a normal that tells of a sharp edge [rad]
constexpr double kMostTurn = 2.0;       // difference of two unit normals, at most
constexpr double kMostSlanting = 12.0;  // parts of a finest cell across slanting edges, at most
constexpr double kSlanting = 3.0;       // length of parts across slanting edges over that across others
// Ends of the sides of a cell along warp and weft.
constexpr std::array<std::array<std::pair<int, int>, 2>, 2> kSides{{{{{0, 1}, {2, 3}}}, {{{0, 2}, {1, 3}}}}};

struct Ball {
  Vec3 centre;
  double radius;
};

/// A ball around the corners of a cell.
Ball ballAround(const Patch& patch, const Field& nodes) {
  Ball ball{Vec3::Zero(), 0.0};
  for (const int corner : patch.nodes) ball.centre += 0.25 * nodes[corner];
  for (const int corner : patch.nodes)
    ball.radius = std::max(ball.radius, (nodes[corner] - ball.centre).norm());
  return ball;
}

}  // namespace

EdgeDivision::EdgeDivision(const Grid& grid, double range, const ClothGaps& gaps)
    : grid_(grid), range_(range), gaps_(gaps) {
  for (auto& turns : turns_) turns.reserve(grid.particles());
}

void EdgeDivision::find(const Solid& sharp, const ActiveMesh& mesh, const Field& nodes) {
  for (auto& turns : turns_) turns.assign(mesh.nodes(), 0.0);
  for (int k = 0; k < static_cast<int>(mesh.patches.size()); ++k) {
    if (gaps_.margin(k) < 0.0) continue;
    const Patch& patch = mesh.patches[k];
    for (const int direction : {kWarp, kWeft}) {
      const double turn = edgeTurn(sharp, patch, direction);
      if (turn == 0.0) continue;
      for (const auto& [c, d] : kSides[direction]) {
        noteEdge(sharp, nodes, patch.nodes[c], patch.nodes[d], turn, turns_[direction]);
        noteEdge(sharp, nodes, patch.nodes[d], patch.nodes[c], turn, turns_[direction]);
      }
    }
  }
}

/// Notes a turn at a node if the normal differs as far away as the range, towards another node.
void EdgeDivision::noteEdge(const Solid& sharp, const Field& nodes, int node, int towards, double turn,
                            std::vector<double>& turns) const {
  const Vec3 way = nodes[towards] - nodes[node];
  const Vec3 there = nodes[node] + std::min(1.0, range_ / way.norm()) * way;
  const Vec3 change = sharp.distance(there).normal - gaps_.nodes().normals[node];
  if (change.norm() > kSharp) turns[node] = std::max(turns[node], turn);
}

/// Turn of a solid's normal over a sharp edge, along two sides of a cell; zero without an edge [rad]. A round
/// face explains a turn of its curvature times the length.
double EdgeDivision::edgeTurn(const Solid& solid, const Patch& patch, int direction) const {
  const double least = kSharp + patch.cell.span() * grid_.spacing(direction) * solid.faceCurvature();
  if (least > kMostTurn) return 0.0;
  double turn = 0.0;
  for (const auto& [c, d] : kSides[direction]) turn = std::max(turn, gaps_.normalTurn(patch, c, d));
  return turn > least ? turn : 0.0;
}

bool EdgeDivision::divide(const Solid& solid, const Patch& patch, const Field& nodes,
                          CellLines& lines) const {
  std::array<double, 2> within, turn;  // over an edge in the cell, and near it
  for (const int direction : {kWarp, kWeft}) {
    turn[direction] = within[direction] = edgeTurn(solid, patch, direction);
    for (const int corner : patch.nodes)
      turn[direction] = std::max(turn[direction], turns_[direction][corner]);
  }
  const bool corner = mayTouchCorner(solid, patch, nodes);
  if (!corner && turn[kWarp] == 0.0 && turn[kWeft] == 0.0) return false;
  // Across a slanting edge, and at a corner of the solid, both rows and columns are dense.
  const bool slants = corner || 2.0 * std::min(turn[kWarp], turn[kWeft]) > std::max(turn[kWarp], turn[kWeft]);
  const int span = patch.cell.span();
  for (const int direction : {kWarp, kWeft}) {
    lines.clear(direction);
    if (!slants && turn[direction] < turn[1 - direction]) {
      const int parts = span * partsAlong(solid, direction);
      if (isTilted(patch, direction)) {
        lines.addEnds(direction, 2 * parts);
      } else {
        lines.addMiddles(direction, parts);
      }
      continue;
    }
    const double across = std::ceil(span * grid_.spacing(direction) / (kCut * range_));
    const double slanting = std::min(std::ceil(across / kSlanting), span * kMostSlanting);
    const double parts = std::max<double>(span, slants ? slanting : across);
    const auto [from, to] = strip(patch, direction, within[direction] > 0.0, nodes);
    const double first = std::floor(from * parts), last = std::ceil(to * parts);
    const auto coarse = [&](double count) { return static_cast<int>(std::ceil(count * span / parts)); };
    lines.addMiddles(direction, coarse(first), 0.0, first / parts);
    lines.addMiddles(direction, static_cast<int>(last - first), first / parts, last / parts);
    lines.addMiddles(direction, coarse(parts - last), last / parts, 1.0);
  }
  return true;
}

bool EdgeDivision::divideEvenly(const Solid& solid, const Patch& patch, const Field& nodes,
                                CellLines& lines) const {
  const Ball ball = ballAround(patch, nodes);
  if (!(solid.edgeDistance(ball.centre) < ball.radius + kBeside * range_)) return false;
  for (const int direction : {kWarp, kWeft}) {
    lines.clear(direction);
    const double parts = std::min(std::ceil(grid_.spacing(direction) / range_), kMostSlanting);
    lines.addMiddles(direction, static_cast<int>(parts));
  }
  return true;
}

/// Tells whether a corner of a solid may press on a cell. The normals at the cell's own corners need not
/// tell: one of the faces that meet there may be nearest to none of them.
bool EdgeDivision::mayTouchCorner(const Solid& solid, const Patch& patch, const Field& nodes) const {
  if (!solid.hasCorners()) return false;
  const Ball ball = ballAround(patch, nodes);
  return solid.cornerDistance(ball.centre) < ball.radius + range_;
}

/// Number of parts of a finest cell along an edge that is as round as the faces, so that it cuts no deeper
/// into them than a share of the range.
int EdgeDivision::partsAlong(const Solid& solid, int direction) const {
  const double length = grid_.spacing(direction), cut = length * length * solid.faceCurvature() / 8.0;
  return static_cast<int>(std::clamp(std::ceil(std::sqrt(cut / (kCut * range_))), 1.0, kMostParts));
}

/// Tells whether a cell rises along an edge, so that the ends of a finest cell are much nearer to the solid
/// than its middle: a fold that crosses the edge touches it there.
bool EdgeDivision::isTilted(const Patch& patch, int direction) const {
  const std::vector<double>& gaps = gaps_.nodes().gaps;
  double rises = 0.0;
  for (const auto& [c, d] : kSides[direction])
    rises = std::max(rises, std::abs(gaps[patch.nodes[c]] - gaps[patch.nodes[d]]));
  return 0.5 * rises / patch.cell.span() > kCut * range_;
}

/// Part of a cell that may press on a sharp edge, as shares of its length along warp or weft. It is known
/// where the sides meet the faces that their ends are nearest to; the edge is between. An edge that slants
/// may leave the cell over one of the other sides, at share 0 or 1.
/// @param within the edge is in the cell, not only near it
std::array<double, 2> EdgeDivision::strip(const Patch& patch, int direction, bool within,
                                          const Field& nodes) const {
  std::array<bool, 2> leaves;
  for (const int end : {0, 1}) {
    const auto& [c, d] = kSides[1 - direction][end];
    leaves[end] = gaps_.normalTurn(patch, c, d) > kSharp;
  }
  double from = 1.0, to = 0.0;
  for (const auto& [c, d] : kSides[direction]) {
    const int a = patch.nodes[c], b = patch.nodes[d];
    const Vec3 way = nodes[b] - nodes[a];
    const double beside = kBeside * range_ / std::max(way.norm(), 1e-300);
    const auto include = [&](double place) {
      from = std::min(from, std::clamp(place - beside, 0.0, 1.0));
      to = std::max(to, std::clamp(place + beside, 0.0, 1.0));
    };
    if (turns_[direction][a] > 0.0 || leaves[0]) include(0.0);
    if (turns_[direction][b] > 0.0 || leaves[1]) include(1.0);
    const Distance at_a = gaps_.nodes()[a], at_b = gaps_.nodes()[b];
    const double sinks = -at_a.normal.dot(way), rises = at_b.normal.dot(way);
    if (within && sinks > 0.0) include(at_a.value / sinks);
    if (within && rises > 0.0) include(1.0 - at_b.value / rises);
  }
  if (from >= to) return {0.0, 1.0};
  return {from, to};
}

}  // namespace haptic_cloth
