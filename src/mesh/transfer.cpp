#include "mesh/transfer.h"

#include <algorithm>
#include <array>
#include <utility>

namespace haptic_cloth {
namespace {

/// Ends of the sides of a cell, as particles.
std::array<std::pair<int, int>, 4> sidesOf(const std::array<int, 4>& c) {
  return {{{c[0], c[1]}, {c[2], c[3]}, {c[0], c[2]}, {c[1], c[3]}}};
}

/// Middle of the diagonal of a cell's triangles.
Vec3 middleOfDiagonal(const Cell& cell, const std::array<int, 4>& c, const std::vector<Vec3>& x) {
  return cell.diagonalRises() ? 0.5 * (x[c[0]] + x[c[3]]) : 0.5 * (x[c[1]] + x[c[2]]);
}

/// Sets the values of hanging particles to the means of their masters.
void setHanging(const ActiveMesh& mesh, std::vector<Vec3>& values) {
  for (const Ghost& g : mesh.ghosts) {
    const int p = mesh.particle[g.node], a = mesh.particle[g.a], b = mesh.particle[g.b];
    values[p] = 0.5 * (values[a] + values[b]);
  }
}

}  // namespace

void interpolateCell(const Grid& grid, const Cell& cell, std::vector<Vec3>& values) {
  const int s = cell.span();
  const auto c = cell.corners(grid);
  for (int j = 0; j <= s; ++j) {
    const double v = static_cast<double>(j) / s;
    for (int i = 0; i <= s; ++i) {
      if (i % s == 0 && j % s == 0) continue;
      const double u = static_cast<double>(i) / s;
      values[grid.particle(cell.i + i, cell.j + j)] = (1 - v) * ((1 - u) * values[c[0]] + u * values[c[1]]) +
                                                      v * ((1 - u) * values[c[2]] + u * values[c[3]]);
    }
  }
}

double movedBySplit(const Grid& grid, const Cell& cell, const std::vector<Vec3>& x) {
  const auto c = cell.corners(grid);
  return 0.25 * (x[c[0]] - x[c[1]] - x[c[2]] + x[c[3]]).norm();
}

double movedByMerge(const Grid& grid, const Cell& parent, const std::vector<Vec3>& x) {
  const auto c = parent.corners(grid);
  double moved = (x[(c[0] + c[3]) / 2] - middleOfDiagonal(parent, c, x)).norm();
  for (const auto& [a, b] : sidesOf(c))
    moved = std::max(moved, (x[(a + b) / 2] - 0.5 * (x[a] + x[b])).norm());
  return moved;
}

void transferAfterSplit(const Grid& grid, const std::vector<Cell>& cells, const std::vector<char>& crowded,
                        ParticleState& state) {
  for (const Cell& cell : cells) {
    const auto c = cell.corners(grid);
    const int middle = (c[0] + c[3]) / 2;
    const auto sides = sidesOf(c);
    for (auto* values : {&state.position, &state.velocity, &state.moved, &state.gained}) {
      auto& x = *values;
      if (x.empty()) continue;
      for (const auto& [a, b] : sides) x[(a + b) / 2] = 0.5 * (x[a] + x[b]);
      x[middle] = 0.25 * (x[c[0]] + x[c[1]] + x[c[2]] + x[c[3]]);
    }
    if (crowded[grid.cell(cell.i, cell.j)])
      state.position[middle] = middleOfDiagonal(cell, c, state.position);
  }
}

namespace {

/// Calls visit(node, weight) for the corners of the cell that now covers a removed particle.
template <class Visit>
void forCorners(const LeafMesh& leaves, const ActiveMesh& mesh, int particle, const Visit& visit) {
  const Grid& grid = mesh.grid;
  const int i = grid.column(particle), j = grid.row(particle);
  const Cell cell = leaves.leafAt(std::min(i, grid.columns - 2), std::min(j, grid.rows - 2));
  const double s = cell.span(), u = (i - cell.i) / s, v = (j - cell.j) / s;
  const double weights[4] = {(1 - u) * (1 - v), u * (1 - v), (1 - u) * v, u * v};
  const auto corners = cell.corners(grid);
  for (int c = 0; c < 4; ++c) {
    if (weights[c] > 0.0) visit(mesh.node[corners[c]], weights[c]);
  }
}

/// Velocities and the changes of the last step: what moves on with the mass.
std::array<std::vector<Vec3>*, 3> motionsOf(ParticleState& state) {
  return {&state.velocity, &state.moved, &state.gained};
}

}  // namespace

MergeTransfer::MergeTransfer(const Grid& grid) {
  active_.reserve(grid.particles());
  masses_.reserve(grid.particles());
  for (auto* list : {&before_, &momentum_}) list->reserve(grid.particles());
  changed_.reserve(grid.particles());
}

void MergeTransfer::capture(const ActiveMesh& mesh) {
  active_.assign(mesh.particle.begin(), mesh.particle.begin() + mesh.active());
  masses_.assign(mesh.mass.begin(), mesh.mass.begin() + mesh.active());
}

void MergeTransfer::give(int node, const Vec3& momentum) {
  momentum_[node] += momentum;
  changed_[node] = 1;
}

void MergeTransfer::apply(const LeafMesh& leaves, const ActiveMesh& mesh, ParticleState& state) {
  for (std::vector<Vec3>* values : motionsOf(state)) {
    if (!values->empty()) apply(leaves, mesh, *values);
  }
  setHanging(mesh, state.position);
}

void MergeTransfer::apply(const LeafMesh& leaves, const ActiveMesh& mesh, std::vector<Vec3>& values) {
  momentum_.assign(mesh.nodes(), Vec3::Zero());
  changed_.assign(mesh.nodes(), 0);
  const int count = static_cast<int>(active_.size());
  before_.resize(count);
  for (int k = 0; k < count; ++k) {
    before_[k] = masses_[k] * values[active_[k]];
    const int n = mesh.node[active_[k]];
    if (n >= 0) momentum_[n] = before_[k];
  }
  for (int k = 0; k < count; ++k) {
    const int p = active_[k];
    if (mesh.node[p] >= 0) continue;
    forCorners(leaves, mesh, p, [&](int node, double weight) { give(node, weight * before_[k]); });
  }
  for (auto g = mesh.ghosts.rbegin(); g != mesh.ghosts.rend(); ++g) {
    const Vec3 half = 0.5 * momentum_[g->node];
    if (half.isZero(0.0)) continue;
    give(g->a, half);
    give(g->b, half);
  }
  for (int n = 0; n < mesh.free; ++n) {
    if (changed_[n]) values[mesh.particle[n]] = momentum_[n] / mesh.mass[n];
  }
  setHanging(mesh, values);
}

}  // namespace haptic_cloth
