/// Finest grid of particles and index arithmetic of its nested levels.
#pragma once

#include <algorithm>
#include <array>

#include "haptic_cloth/types.h"

namespace haptic_cloth {

/// Grid of I × J particles at the crossings of warp (i, x) and weft (j, y). Level l has a spacing
/// of 2^l finest cells.
struct Grid {
  int columns;  ///< I
  int rows;     ///< J
  int levels;   ///< L, the coarsest level; (I-1) and (J-1) are divisible by 2^L
  double dx;    ///< finest spacing along warp [m]
  double dy;    ///< finest spacing along weft [m]

  int particles() const { return columns * rows; }
  int cells() const { return (columns - 1) * (rows - 1); }
  int particle(int i, int j) const { return j * columns + i; }
  int cell(int i, int j) const { return j * (columns - 1) + i; }
  int column(int particle) const { return particle % columns; }
  int row(int particle) const { return particle / columns; }
  double spacing(int direction) const { return direction == kWarp ? dx : dy; }  ///< finest [m]
  double longestSpacing() const { return std::max(dx, dy); }                    ///< finest [m]
  double shortestSpacing() const { return std::min(dx, dy); }                   ///< finest [m]
};

/// Square of 2^level × 2^level finest cells with its lower left corner at particle (i, j).
struct Cell {
  int i, j, level;

  int span() const { return 1 << level; }

  /// Longer side in the flat cloth [m].
  double length(const Grid& grid) const { return span() * grid.longestSpacing(); }

  /// Tells whether the two triangles of this leaf meet along the line from corner 0 to corner 3; else
  /// they meet from 1 to 2. The children of a leaf divide its triangles; mirror images have mirrored
  /// triangles.
  bool diagonalRises() const { return ((i >> level) + (j >> level)) % 2 == 0; }

  /// Particles (i,j), (i+s,j), (i,j+s), (i+s,j+s).
  std::array<int, 4> corners(const Grid& grid) const {
    const int s = span();
    return {grid.particle(i, j), grid.particle(i + s, j), grid.particle(i, j + s),
            grid.particle(i + s, j + s)};
  }
};

}  // namespace haptic_cloth
