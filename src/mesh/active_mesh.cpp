#include "mesh/active_mesh.h"

#include <algorithm>
#include <cmath>

namespace haptic_cloth {
namespace {

enum Role : char { kInactive, kCorner, kGhost };

}  // namespace

ActiveMesh::ActiveMesh(const LeafMesh& leaves, double areal_density)
    : grid(leaves.grid()), areal_density_(areal_density) {
  const std::size_t n = grid.particles();
  int slots = 0;
  for (int level = 0; level <= grid.levels; ++level) {
    level_offset_.push_back(slots);
    slots += (((grid.columns - 1) >> level) + 1) * (((grid.rows - 1) >> level) + 1);
  }
  for (auto& widths : side_width_) widths.resize(slots);
  for (auto& edges_of_sides : side_edge_) edges_of_sides.resize(slots);
  particle.reserve(n);
  mass.reserve(n);
  node.resize(n);
  role_.resize(n);
  ghosts.reserve(n / 2);
  edges.reserve(2 * n + n / 2);
  triples.reserve(2 * n);
  patches.reserve(grid.cells());
  patch_corners.reserve(padded(grid.cells()) / kPack);
  cells_.reserve(grid.cells());
  rebuild(leaves);
}

void ActiveMesh::rebuild(const LeafMesh& leaves) {
  leaves.leaves(cells_);
  numberNodes(leaves);
  findGhosts();
  listPatches();
  lumpMass();
  buildEdges();
  buildTriples(leaves);
}

void ActiveMesh::listPatches() {
  patches.clear();
  patch_corners.assign(padded(static_cast<int>(cells_.size())) / kPack, PatchCorners{});
  for (const Cell& cell : cells_) {
    const double s = cell.span();
    Patch patch{cell.corners(grid), cell, s * grid.dx * (s * grid.dy), {}};
    const int k = static_cast<int>(patches.size());
    for (int c = 0; c < 4; ++c) {
      patch.nodes[c] = node[patch.nodes[c]];
      patch_corners[k / kPack].at[c].index[k % kPack] = patch.nodes[c];
    }
    patches.push_back(patch);
  }
  for (PatchCorners& pack : patch_corners) {
    for (PackIndices& nodes : pack.at) nodes.finish();
  }
}

void ActiveMesh::numberNodes(const LeafMesh& leaves) {
  std::fill(role_.begin(), role_.end(), kInactive);
  for (const Cell& cell : cells_) {
    for (const int corner : cell.corners(grid)) role_[corner] = kCorner;
  }
  for (const Cell& cell : cells_) {
    if (cell.level == 0) continue;
    const int s = cell.span(), half = s / 2;
    for (const int middle :
         {grid.particle(cell.i + half, cell.j), grid.particle(cell.i + half, cell.j + s),
          grid.particle(cell.i, cell.j + half), grid.particle(cell.i + s, cell.j + half)}) {
      if (role_[middle] != kInactive) role_[middle] = kGhost;
    }
  }
  particle.clear();
  const auto append = [&](auto wanted) {
    const int before = nodes();
    for (int p = 0; p < grid.particles(); ++p) {
      if (wanted(p)) particle.push_back(p);
    }
    return nodes() - before;
  };
  free = append([&](int p) { return role_[p] == kCorner && !leaves.pinned(p); });
  pinned = append([&](int p) { return role_[p] == kCorner && leaves.pinned(p); });
  append([&](int p) { return role_[p] == kGhost; });
  std::fill(node.begin(), node.end(), -1);
  for (int n = 0; n < nodes(); ++n) node[particle[n]] = n;
}

void ActiveMesh::findGhosts() {
  ghosts.clear();
  for (int level = grid.levels; level > 0; --level) {
    for (const Cell& cell : cells_) {
      if (cell.level != level) continue;
      const std::array<int, 4> c = cell.corners(grid);
      for (const auto& [a, b] : {std::pair(c[0], c[1]), {c[2], c[3]}, {c[0], c[2]}, {c[1], c[3]}}) {
        const int middle =
            (a + b) / 2;  // exact: a and b lie on one grid line, an even number of particles apart
        if (role_[middle] != kGhost) continue;
        ghosts.push_back({node[middle], node[a], node[b]});
      }
    }
  }
}

void ActiveMesh::lumpMass() {
  mass.assign(nodes(), 0.0);
  for (const Patch& patch : patches) {
    for (const int n : patch.nodes) mass[n] += 0.25 * areal_density_ * patch.area;
  }
  handOverGhosts(mass);
  std::fill(mass.begin() + active(), mass.end(), 0.0);
}

/// Builds the edges. Every cell gives half of its width to each side; a side shared by cells of one
/// level is one edge.
void ActiveMesh::buildEdges() {
  for (auto& widths : side_width_) std::fill(widths.begin(), widths.end(), 0.0F);
  const auto forSides = [&](const Cell& cell, const auto& visit) {
    const int s = cell.span();
    visit(0, kWarp, sideSlot(cell.level, cell.i, cell.j));
    visit(1, kWarp, sideSlot(cell.level, cell.i, cell.j + s));
    visit(2, kWeft, sideSlot(cell.level, cell.i, cell.j));
    visit(3, kWeft, sideSlot(cell.level, cell.i + s, cell.j));
  };
  for (const Cell& cell : cells_) {
    forSides(cell, [&](int, int direction, int slot) {
      side_width_[direction][slot] += 0.5F * static_cast<float>(cell.span());
    });
  }
  edges.clear();
  numberEdges(kWarp);
  numberEdges(kWeft);
  for (Patch& patch : patches) {
    forSides(patch.cell,
             [&](int side, int direction, int slot) { patch.sides[side] = side_edge_[direction][slot]; });
  }
}

int ActiveMesh::sideSlot(int level, int i, int j) const {
  const int columns = ((grid.columns - 1) >> level) + 1;
  return level_offset_[level] + (j >> level) * columns + (i >> level);
}

/// Numbers the edges of one direction by their first nodes, so that neighbours in a row follow one
/// another.
void ActiveMesh::numberEdges(int direction) {
  const double along = grid.spacing(direction), across = grid.spacing(1 - direction);
  for (int n = 0; n < nodes(); ++n) {
    const int i = grid.column(particle[n]), j = grid.row(particle[n]);
    for (int level = 0; level <= grid.levels; ++level) {
      const int s = 1 << level;
      if (i % s != 0 || j % s != 0) break;
      const int slot = sideSlot(level, i, j);
      const double width = side_width_[direction][slot];
      if (width == 0.0) continue;
      side_edge_[direction][slot] = static_cast<int>(edges.size());
      const int b = direction == kWarp ? grid.particle(i + s, j) : grid.particle(i, j + s);
      edges.push_back({n, node[b], direction, s * along, width * across});
    }
  }
}

void ActiveMesh::buildTriples(const LeafMesh& leaves) {
  triples.clear();
  for (const int direction : {kWarp, kWeft}) {
    for (int n = 0; n < active(); ++n) addTriple(leaves, n, direction);
  }
}

void ActiveMesh::addTriple(const LeafMesh& leaves, int centre, int direction) {
  const int p = particle[centre], i = grid.column(p), j = grid.row(p);
  const bool warp = direction == kWarp;
  const int position = warp ? i : j, last = (warp ? grid.columns : grid.rows) - 1;
  if (position == 0 || position == last) return;
  const double along = warp ? grid.dx : grid.dy, across = warp ? grid.dy : grid.dx;

  // Each side of the centre has one or two cells. The coarser gives the arm, both give the width.
  int arm[2] = {0, 0};
  double width[2] = {0.0, 0.0};
  for (const int side : {0, 1}) {
    for (const int half : {0, 1}) {
      const int ci = warp ? i - 1 + side : i - 1 + half, cj = warp ? j - 1 + half : j - 1 + side;
      if (ci < 0 || cj < 0 || ci > grid.columns - 2 || cj > grid.rows - 2) continue;
      const int s = leaves.leafAt(ci, cj).span();
      arm[side] = std::max(arm[side], s);
      width[side] += 0.5 * s * across;
    }
  }
  const int stride = warp ? 1 : grid.columns;
  const int l = node[p - arm[0] * stride], r = node[p + arm[1] * stride];
  const auto held = [&](int n) { return n >= free && n < active(); };
  const bool left_rigid = held(centre) && held(l), right_rigid = held(centre) && held(r);
  if (left_rigid && right_rigid) return;

  // A rigid arm has no length that can bend, so only the other half counts.
  const double l1 = arm[0] * along, l2 = arm[1] * along;
  const double bent = 0.5 * ((left_rigid ? 0.0 : l1) + (right_rigid ? 0.0 : l2));
  const double area = std::max(width[0], width[1]) * bent;
  const double length = std::sqrt(bent * std::sqrt(l1 * l2));
  triples.push_back(
      {l, centre, r, direction, 1.0 / (bent * l1), 1.0 / (bent * l2), area, length, 0.0, centre, centre});
  if (l >= active() || r >= active()) subtractSagitta(triples.back(), arm[l >= active() ? 0 : 1]);
}

/// Makes up for arms that end on hanging nodes. Then c is the centre of a cell that was split, and its four
/// neighbours at `arm` cells are the middles of the cell's sides. A middle that hangs is off the surface by
/// ½ l² times the curvature along its side. So the curvatures along the thread, κ, and across, κ', follow
/// from those that are measured, X and Y, by
///
///     X = κ + α κ',   Y = κ' + β κ   ⇒   κ = (X - α Y) / (1 - α β)
///
/// with α from the arms and β from the nodes beside c. The area is multiplied by the share 1 - α β, which
/// keeps a uniform moment in equilibrium. If all four hang, X = Y = κ + κ': then each counts half of the sum.
void ActiveMesh::subtractSagitta(Triple& triple, int arm) const {
  const bool warp = triple.direction == kWarp;
  const int other = arm * (warp ? grid.columns : 1), p = particle[triple.c];
  const double along = arm * (warp ? grid.dx : grid.dy);
  const auto hangs = [this](int n) { return n >= active() ? 0.5 : 0.0; };
  triple.a = node[p - other];
  triple.b = node[p + other];
  triple.sagitta = hangs(triple.l) * triple.left + hangs(triple.r) * triple.right;
  constexpr double kLeastShare = 0.25;  // it is ½ or more, or none
  const double share = 1.0 - along * along * triple.sagitta * (hangs(triple.a) + hangs(triple.b));
  if (share < kLeastShare) {
    triple.sagitta *= 0.5;
    return;
  }
  for (double* coefficient : {&triple.left, &triple.right, &triple.sagitta}) *coefficient /= share;
  triple.area *= share;
}

}  // namespace haptic_cloth
