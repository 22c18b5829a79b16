/// Points of the cloth that may become samples of a solid.
#pragma once

#include <array>
#include <vector>

#include "contact/sample_list.h"
#include "contact/solid.h"
#include "mesh/active_mesh.h"
#include "mesh/field.h"

namespace haptic_cloth {

/// Lines across a cell, whose crossings are points: columns at places along warp, rows along weft.
class CellLines {
 public:
  struct Line {
    double at, width;  ///< its place and what it stands for, as shares of the cell's length
  };

  /// @param most lines along a direction
  void reserve(int most) {
    for (auto& lines : lines_) lines.reserve(most);
  }
  void clear(int direction) { lines_[direction].clear(); }

  /// Lays lines through the middles of equal parts of a cell's sides along one direction, from one share of
  /// their length to another.
  void addMiddles(int direction, int parts, double from = 0.0, double to = 1.0);

  /// Lays lines through the ends of equal parts of a cell's sides along one direction.
  void addEnds(int direction, int parts);

  const std::vector<Line>& along(int direction) const { return lines_[direction]; }

 private:
  std::array<std::vector<Line>, 2> lines_;
};

/// Candidates for the samples of one group.
class Candidates {
 public:
  void reserve(int points);
  void clear();

  int size() const { return static_cast<int>(points_.size()); }
  const SurfacePoint& point(int k) const { return points_[k]; }
  const Field& places() const { return places_; }     ///< positions, of at least as many points [m]
  double margin(int k) const { return margins_[k]; }  ///< largest gap at which it counts [m]

  void add(const SurfacePoint& point, const Vec3& place, double margin);

  /// Adds the corners of parts × parts equal parts of a cell but its own; each stands for the area around it
  /// within the cell.
  void addCorners(const Patch& patch, int parts, const Field& nodes, double margin);

  /// Adds the middles of a cell and of its sides, with their weights by Simpson's rule.
  void addMiddles(const Patch& patch, const Field& nodes, double margin);

  /// Adds the points of a cell where lines cross, if they may be near a solid.
  void addCrossings(const CellLines& lines, const Patch& patch, const Solid& solid, const Field& nodes,
                    double margin);

 private:
  std::vector<SurfacePoint> points_;
  std::vector<double> margins_;
  Field places_;
};

}  // namespace haptic_cloth
