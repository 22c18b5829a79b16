#include "mesh/active_mesh.h"

#include <algorithm>

namespace haptic_cloth {
namespace {

enum Role : char { kInactive, kCorner, kGhost };

}  // namespace

ActiveMesh::ActiveMesh(const LeafMesh& leaves, double areal_density, bool twist)
    : grid(leaves.grid()), slots_per_patch(twist ? 3 : 2), areal_density_(areal_density) {
  const std::size_t n = grid.particles();
  int slots = 0;
  for (int level = 0; level <= grid.levels; ++level) {
    level_offset_.push_back(slots);
    slots += (((grid.columns - 1) >> level) + 1) * (((grid.rows - 1) >> level) + 1);
  }
  for (auto& map : edge_of_slot_) map.resize(slots);
  for (auto* list : {&particle, &rows}) list->reserve(n + 1);
  mass.reserve(n);
  node.resize(n);
  role_.resize(n);
  ghosts.reserve(n / 2);
  edges.reserve(2 * n + n / 2);
  triples.reserve(2 * n);
  patches.reserve(grid.cells());
  cells_.reserve(grid.cells());
  incidences.reserve(2 * edges.capacity() + 3 * triples.capacity() +
                     4 * (slots_per_patch - 1) * patches.capacity());
  rebuild(leaves);
}

void ActiveMesh::rebuild(const LeafMesh& leaves) {
  leaves.leaves(cells_);
  numberNodes(leaves);
  findGhosts();
  patches.clear();
  for (const Cell& cell : cells_) {
    const double s = cell.span();
    Patch patch{cell.corners(grid), cell, s * grid.dx * (s * grid.dy), {}};
    for (int& corner : patch.nodes) corner = node[corner];
    patches.push_back(patch);
  }
  lumpMass();
  buildEdges();
  buildTriples(leaves);
  buildIncidences();
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
            (a + b) / 2;  // exact: both lie on one grid line, an even number of particles apart
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

void ActiveMesh::buildEdges() {
  edges.clear();
  for (auto& map : edge_of_slot_) std::fill(map.begin(), map.end(), -1);
  for (Patch& patch : patches) {
    const Cell& cell = patch.cell;
    const int s = cell.span();
    patch.sides = {addSide(cell, cell.i, cell.j, kWarp), addSide(cell, cell.i, cell.j + s, kWarp),
                   addSide(cell, cell.i, cell.j, kWeft), addSide(cell, cell.i + s, cell.j, kWeft)};
  }
}

/// Gives half of a cell's width to one of its sides. @return the edge there
int ActiveMesh::addSide(const Cell& cell, int i, int j, int direction) {
  const int s = cell.span();
  const double along = direction == kWarp ? grid.dx : grid.dy,
               across = direction == kWarp ? grid.dy : grid.dx;
  const int columns = ((grid.columns - 1) >> cell.level) + 1;
  int& edge =
      edge_of_slot_[direction][level_offset_[cell.level] + (j >> cell.level) * columns + (i >> cell.level)];
  if (edge < 0) {
    edge = static_cast<int>(edges.size());
    const int a = grid.particle(i, j);
    const int b = direction == kWarp ? grid.particle(i + s, j) : grid.particle(i, j + s);
    edges.push_back({node[a], node[b], direction, s * along, 0.0});
  }
  edges[edge].width += 0.5 * s * across;
  return edge;
}

void ActiveMesh::buildTriples(const LeafMesh& leaves) {
  triples.clear();
  for (int n = 0; n < active(); ++n) {
    for (const int direction : {kWarp, kWeft}) addTriple(leaves, n, direction);
  }
}

void ActiveMesh::addTriple(const LeafMesh& leaves, int centre, int direction) {
  const int p = particle[centre], i = grid.column(p), j = grid.row(p);
  const bool warp = direction == kWarp;
  const int position = warp ? i : j, last = (warp ? grid.columns : grid.rows) - 1;
  if (position == 0 || position == last) return;
  const double along = warp ? grid.dx : grid.dy, across = warp ? grid.dy : grid.dx;

  // Each side of the centre has one or two cells; the coarser gives the arm, both together the width.
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

  // A rigid arm has no length of its own to bend: only the free half cell does.
  const double l1 = arm[0] * along, l2 = arm[1] * along;
  const double bent = 0.5 * ((left_rigid ? 0.0 : l1) + (right_rigid ? 0.0 : l2));
  triples.push_back(
      {l, centre, r, direction, 1.0 / (bent * l1), 1.0 / (bent * l2), std::max(width[0], width[1]) * bent});
}

void ActiveMesh::buildIncidences() {
  rows.assign(nodes() + 1, 0);
  const int first_triple = static_cast<int>(edges.size());
  const int first_patch = first_triple + static_cast<int>(triples.size());
  const auto visit = [&](const auto& put) {
    for (int e = 0; e < first_triple; ++e) {
      put(edges[e].a, e, -1.0);
      put(edges[e].b, e, 1.0);
    }
    for (int t = first_triple; t < first_patch; ++t) {
      const Triple& triple = triples[t - first_triple];
      put(triple.l, t, triple.left);
      put(triple.c, t, -(triple.left + triple.right));
      put(triple.r, t, triple.right);
    }
    for (int k = 0; k < static_cast<int>(patches.size()); ++k) {
      const auto& n = patches[k].nodes;
      const int slot = first_patch + slots_per_patch * k;
      put(n[0], slot, -1.0);
      put(n[3], slot, 1.0);
      put(n[1], slot + 1, 1.0);
      put(n[2], slot + 1, -1.0);
      if (slots_per_patch < 3) continue;
      for (const int corner : {0, 3}) put(n[corner], slot + 2, 1.0);
      for (const int corner : {1, 2}) put(n[corner], slot + 2, -1.0);
    }
  };
  visit([&](int n, int, double) { ++rows[n + 1]; });
  for (int n = 0; n < nodes(); ++n) rows[n + 1] += rows[n];
  incidences.resize(rows[nodes()]);
  visit([&](int n, int slot, double coefficient) { incidences[rows[n]++] = {slot, coefficient}; });
  for (int n = nodes(); n > 0; --n) rows[n] = rows[n - 1];
  rows[0] = 0;
}

}  // namespace haptic_cloth
