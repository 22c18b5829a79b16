#include "sim/turn_estimate.h"

#include <algorithm>
#include <cmath>
#include <limits>

#include "sim/cloth_objective.h"

namespace haptic_cloth {
namespace {

/// Compression of a particle that is not in the mesh: less than any [N/m].
constexpr double kNone = std::numeric_limits<double>::lowest();

constexpr double kCurvature = 50.0;     ///< that cloth takes easily: a fold of radius 20 mm [1/m]
constexpr double kCompressed = -0.005;  ///< strain of a thread that a merge shortens [-]

/// Secant of a law's middle line.
double secant(const Loop& law, double at) {
  return 0.5 * (law.upper()(at).force + law.lower()(at).force) / at;
}

}  // namespace

TurnEstimate::TurnEstimate(const Fabric& fabric, const Grid& grid, const Vec3& gravity)
    : grid_(grid),
      density_(fabric.areal_density),
      gravity_(referenceAcceleration(gravity)),
      rigidity_{secant(fabric.bending[kWarp], kCurvature), secant(fabric.bending[kWeft], kCurvature)},
      compressive_{secant(fabric.tensile[kWarp], kCompressed), secant(fabric.tensile[kWeft], kCompressed)},
      range_(fabric.thickness),
      weight_(density_ * gravity_ * (grid.columns - 1) * grid.dx * (grid.rows - 1) * grid.dy),
      width_(std::sqrt((grid.columns - 1) * grid.dx * (grid.rows - 1) * grid.dy)),
      edge_means_(grid.particles()) {
  for (auto& tension : tension_) tension.reserve(grid.particles());
  for (auto& compression : compression_) compression.assign(grid.particles(), kNone);
  curvature_.reserve(grid.particles());
  sum_.reserve(grid.particles());
}

double TurnEstimate::turnUnder(double load, double tension, double length) const {
  constexpr double kSag = 2.5;  // in thicknesses
  const double bending = 8.0 * (rigidity_[kWarp] + rigidity_[kWeft]) / (length * length);
  const double stiffness = tension + bending + 0.5 * density_ * gravity_ * length;
  const double turn = load * length / stiffness, sag = turn * length / 8.0;
  return sag > kSag * range_ ? turn : 0.0;
}

void TurnEstimate::serialize(Archive& archive) {
  archive("compression.warp", compression_[kWarp]);
  archive("compression.weft", compression_[kWeft]);
}

void TurnEstimate::begin(const View& view, double least) {
  least_ = least;
  const auto tension = [&view](int e) { return view.internal.tension(e, view.nodes); };
  for (const int direction : {kWarp, kWeft}) {
    edge_means_.compute(view.mesh, direction, tension, tension_[direction]);
    followCompression(view, direction);
  }
  measureCurvature(view);
}

/// Compression of each particle: rises at once, so that cells split before they buckle, and falls
/// slowly, so that they do not merge while a fold forms.
void TurnEstimate::followCompression(const View& view, int direction) {
  constexpr double kFalls = 0.07;  // time constant [s]
  const double share = 1.0 - std::exp(-view.look_time / kFalls);
  for (int p = 0; p < grid_.particles(); ++p) {
    const int n = view.mesh.node[p];
    double& compression = compression_[direction][p];
    if (n < 0) {
      compression = kNone;
    } else {
      const double now = -tension_[direction][n];
      compression = std::max(now, compression + share * (now - compression));
    }
  }
}

/// Curvature of the nodes. That of a thread counts twice where tension presses the cloth on a solid harder
/// than weight could.
void TurnEstimate::measureCurvature(const View& view) {
  constexpr double kPress = 2.0, kCounts = 2.0;  // over the weight of the cloth; times
  curvature_.assign(view.mesh.nodes(), 0.0);
  sum_.assign(view.mesh.nodes(), 0.0);
  for (int t = 0; t < static_cast<int>(view.mesh.triples.size()); ++t) {
    const Triple& triple = view.mesh.triples[t];
    const double curvature = view.internal.curvature(t, view.nodes), size = std::abs(curvature);
    const double pressure = tension_[triple.direction][triple.c] * size;
    const double counts = pressure > kPress * density_ * gravity_ ? kCounts : 1.0;
    curvature_[triple.c] = std::max(curvature_[triple.c], counts * size);
    sum_[triple.c] += curvature;
  }
  for (int n = 0; n < view.mesh.nodes(); ++n) curvature_[n] = std::max(curvature_[n], std::abs(sum_[n]));
}

double TurnEstimate::turn(const View& view, const Cell& cell, int parts, double enough) const {
  double largest = visible(view, cell, parts);
  for (const auto hidden : {&TurnEstimate::bend, &TurnEstimate::missing, &TurnEstimate::buckle}) {
    if (largest > enough) break;
    largest = std::max(largest, (this->*hidden)(view, cell, parts));
  }
  return largest;
}

/// A cell carries its largest tension, at the nodes that visible() looks at, times its length. Cloth that
/// hangs has tension of its own, which does not count; nor does a touch that has only begun. Merges need less
/// load than splits, against chatter: the mesh changes the tension.
bool TurnEstimate::carries(const View& view, const Cell& cell, int parts, double share) const {
  constexpr double kOwn = 3.0;     // over the weight of the cloth by its width
  constexpr double kMerge = 0.25;  // of the load that keeps a cell from merging, over that of a split
  if (view.touches.empty()) return false;
  double force = weight_, tension = 0.0;
  for (const Touch& touch : view.touches) force = std::max(force, touch.force);
  const int step = cell.span() / parts;
  for (int j = 0; j <= parts; ++j) {
    for (int i = 0; i <= parts; ++i) {
      const int n = view.mesh.node[grid_.particle(cell.i + i * step, cell.j + j * step)];
      tension = std::max({tension, tension_[kWarp][n], tension_[kWeft][n]});
    }
  }
  const double carried = (tension - kOwn * weight_ / width_) * cell.length(grid_);
  return carried > (parts == 2 ? kMerge : 1.0) * share * force;
}

/// Turning angle over a cell, from the nodes at its corners or at the corners of its four children.
double TurnEstimate::visible(const View& view, const Cell& cell, int parts) const {
  const int step = cell.span() / parts;
  double largest = 0.0;
  for (int j = 0; j <= parts; ++j) {
    for (int i = 0; i <= parts; ++i) {
      const int particle = grid_.particle(cell.i + i * step, cell.j + j * step);
      largest = std::max(largest, curvature_[view.mesh.node[particle]]);
    }
  }
  return largest * cell.length(grid_);
}

/// Turning angle of a cell if it could bend. The load is that on cloth which no obstacle carries,
/// at most the weight of the cloth: a larger load is an impact, over before a cell bends. Above an
/// uneven obstacle part of the cell will have to carry itself soon.
double TurnEstimate::bend(const View& view, const Cell& cell, int parts) const {
  const double length = cell.length(grid_);
  if (turnUnder(density_ * gravity_, 0.0, length) <= least_) return 0.0;
  const Under below = under(view, cell, points(view, cell, parts));
  if (below == Under::Even) return 0.0;
  double tension = 0.0, weight = 0.0;
  for (const int corner : cell.corners(grid_)) {
    const int n = view.mesh.node[corner];
    for (const int direction : {kWarp, kWeft}) tension += 0.25 * std::max(0.0, tension_[direction][n]);
    weight += 0.25 * view.weight[n];
  }
  const double carries = below == Under::Uneven ? gravity_ : std::min(std::abs(weight), gravity_);
  return turnUnder(density_ * carries, tension, length);
}

/// Turning angle for the load of the cell that the force on a probe would lack.
double TurnEstimate::missing(const View& view, const Cell& cell, int parts) const {
  constexpr double kShare = 0.02, kLeast = 0.01;  // no device renders less force [N]
  if (view.touches.empty()) return 0.0;
  const double finest = grid_.longestSpacing(), length = cell.length(grid_);
  const double area = length * length - finest * finest;  // the finest mesh lacks its share, too
  const double turn_by_load = area / (kShare * std::max(kLeast, leastForce(view, cell))) * view.split_turn;
  if (density_ * gravity_ * turn_by_load <= least_) return 0.0;
  if (under(view, cell, points(view, cell, parts)) == Under::Even) return 0.0;
  return density_ * std::min(weightAround(view, cell), gravity_) * turn_by_load;
}

/// Turning angle for the compression of a cell over the load at which finer cells would buckle. A merge
/// turns bent threads into chords, and by as much as these are shorter it compresses the threads.
double TurnEstimate::buckle(const View& view, const Cell& cell, int parts) const {
  constexpr double kEuler = 9.8696;  // π²
  constexpr double kOver = 2.0;      // over that load
  constexpr double kHeld = 0.1;      // of the cell's weight; solves leave as much unbalanced
  const int step = cell.span() / parts;
  double largest = 0.0;
  for (const int direction : {kWarp, kWeft}) {
    const double length = cell.span() * grid_.spacing(direction);
    const double bears =
        kOver * (kEuler * rigidity_[direction] / (length * length) + kHeld * density_ * gravity_ * length);
    const auto particle = [&](int along, int across) {
      return direction == kWarp ? grid_.particle(cell.i + along, cell.j + across)
                                : grid_.particle(cell.i + across, cell.j + along);
    };
    const auto position = [&](int along, int across) {
      return view.nodes[view.mesh.node[particle(along, across)]];
    };
    for (int line = 0; line <= parts; ++line) {
      const int across = line * step;
      double compression = 0.0;
      for (int k = 0; k <= parts; ++k)
        compression += compression_[direction][particle(k * step, across)] / (parts + 1);
      if (parts == 2) {
        const double chord = (position(cell.span(), across) - position(0, across)).norm();
        compression = std::max(compression, compressive_[direction] * (1.0 - chord / length));
      }
      largest = std::max(largest, compression / bears);
    }
  }
  return largest * view.split_turn;
}

/// Smallest force on a probe that a wave from the cell reaches; infinite if there is none [N].
double TurnEstimate::leastForce(const View& view, const Cell& cell) const {
  constexpr double kWaves = 3.0;
  const double reach = 0.71 * cell.length(grid_);  // from the centre to a corner
  Vec3 centre = Vec3::Zero();
  for (const int corner : cell.corners(grid_)) centre += 0.25 * view.nodes[view.mesh.node[corner]];
  double least = std::numeric_limits<double>::infinity();
  for (const Touch& touch : view.touches) {
    const double wave = 4.0 * touch.radius;
    if ((centre - touch.position).norm() < kWaves * wave + reach) least = std::min(least, touch.force);
  }
  return least;
}

/// Largest weight of the nodes of a cell and of half a cell around it: waves travel that far before
/// the mesh is fine enough for them. @pre not a finest cell
double TurnEstimate::weightAround(const View& view, const Cell& cell) const {
  const int half = cell.span() / 2, size = cell.span();
  double largest = 0.0;
  for (int j = std::max(0, cell.j - half); j <= std::min(grid_.rows - 1, cell.j + size + half); j += half) {
    for (int i = std::max(0, cell.i - half); i <= std::min(grid_.columns - 1, cell.i + size + half);
         i += half) {
      const int n = view.mesh.node[grid_.particle(i, j)];
      if (n >= 0) largest = std::max(largest, std::abs(view.weight[n]));
    }
  }
  return largest;
}

/// Corners, middles of the sides and centre of a cell, row by row.
TurnEstimate::Points TurnEstimate::points(const View& view, const Cell& cell, int parts) const {
  Points x;
  const int half = cell.span() / 2;
  for (int j = 0; j <= 2; ++j) {
    for (int i = 0; i <= 2; ++i) {
      if (parts == 1 && (i == 1 || j == 1)) continue;
      x[3 * j + i] = view.nodes[view.mesh.node[grid_.particle(cell.i + i * half, cell.j + j * half)]];
    }
  }
  if (parts == 1) {
    for (const int row : {0, 6}) x[row + 1] = 0.5 * (x[row] + x[row + 2]);
    for (const int column : {0, 1, 2}) x[3 + column] = 0.5 * (x[column] + x[6 + column]);
  }
  return x;
}

/// Position of obstacles under the cell. Uneven: one is within reach and does not lie evenly under
/// it.
TurnEstimate::Under TurnEstimate::under(const View& view, const Cell& cell, const Points& points) const {
  constexpr double kEven = 0.5, kTouches = 1.5;  // in ranges of contact
  // Largest distance of a place in the cell to the nearest point, in cell lengths.
  constexpr double kApart = 0.36;
  Vec3 velocity = Vec3::Zero();
  for (const int corner : cell.corners(grid_)) velocity += 0.25 * view.velocities[view.mesh.node[corner]];
  const double length = cell.length(grid_);
  const double looks = 2.0 * cell.level;  // decisions needed to reach the finest cells, times two
  const double reach = range_ + looks * view.look_time * velocity.norm();
  Under under = Under::Nothing;
  for (int k = 0; k < view.contacts.obstacles(); ++k) {
    const Solid& solid = view.contacts.obstacle(k);
    const double near = reach + looks * view.contacts.obstacleSpeed(k) * view.look_time;
    if (solid.distance(points[4]).value > near + (0.71 + kApart) * length) continue;
    double least = std::numeric_limits<double>::infinity(), most = -least;
    for (const Vec3& point : points) {
      const double gap = solid.distance(point).value;
      least = std::min(least, gap);
      most = std::max(most, gap);
    }
    if (most - least > kEven * range_) {
      if (least < near + kApart * length) return Under::Uneven;
    } else if (most < kTouches * range_) {
      under = Under::Even;
    }
  }
  return under;
}

}  // namespace haptic_cloth
