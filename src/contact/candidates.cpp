#include "contact/candidates.h"

#include <algorithm>
#include <cmath>

namespace haptic_cloth {
namespace {

constexpr int kChunk = 512;  // growth of the array of places [points]

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

void CellLines::addMiddles(int direction, int parts, double from, double to) {
  const double width = (to - from) / parts;
  for (int k = 0; k < parts; ++k) lines_[direction].push_back({from + (k + 0.5) * width, width});
}

void CellLines::addEnds(int direction, int parts) {
  for (int k = 0; k <= parts; ++k)
    lines_[direction].push_back({double(k) / parts, (k % parts == 0 ? 0.5 : 1.0) / parts});
}

void Candidates::reserve(int points) {
  points_.reserve(points);
  margins_.reserve(points);
  places_.reserve(points + kChunk);
}

void Candidates::clear() {
  points_.clear();
  margins_.clear();
}

void Candidates::add(const SurfacePoint& point, const Vec3& place, double margin) {
  const int index = size();
  if (index >= places_.size()) places_.resize(index + kChunk);
  places_.set(index, place);
  margins_.push_back(margin);
  points_.push_back(point);
}

void Candidates::addCorners(const Patch& patch, int parts, const Field& nodes, double margin) {
  for (int j = 0; j <= parts; ++j) {
    const double v = static_cast<double>(j) / parts;
    const Row row(patch, v, nodes);
    for (int i = 0; i <= parts; ++i) {
      if (i % parts == 0 && j % parts == 0) continue;
      const double u = static_cast<double>(i) / parts;
      const double share = (i % parts == 0 ? 0.5 : 1.0) * (j % parts == 0 ? 0.5 : 1.0);
      add(surfacePoint(patch, u, v, share * patch.area / (parts * parts)), row.at(u), margin);
    }
  }
}

void Candidates::addMiddles(const Patch& patch, const Field& nodes, double margin) {
  for (int j = 0; j <= 2; ++j) {
    const Row row(patch, 0.5 * j, nodes);
    for (int i = 0; i <= 2; ++i) {
      if (i != 1 && j != 1) continue;
      const double weight = (i == 1 ? 4.0 : 1.0) * (j == 1 ? 4.0 : 1.0) / 36.0;
      add(surfacePoint(patch, 0.5 * i, 0.5 * j, weight * patch.area), row.at(0.5 * i), margin);
    }
  }
}

void Candidates::addCrossings(const CellLines& lines, const Patch& patch, const Solid& solid,
                              const Field& nodes, double margin) {
  for (const auto& [v, height] : lines.along(kWeft)) {
    const Row row(patch, v, nodes);
    const Window window(row, solid.position(), solid.extent() + margin);
    for (const auto& [u, width] : lines.along(kWarp)) {
      if (u < window.first || u > window.last) continue;
      add(surfacePoint(patch, u, v, width * height * patch.area), row.at(u), margin);
    }
  }
}

}  // namespace haptic_cloth
