#include "mesh/triangle_surface.h"

namespace haptic_cloth {

TriangleSurface::TriangleSurface(const Grid& grid) {
  const std::size_t n = grid.particles(), cells = grid.cells();
  triangles_.reserve(2 * cells);
  nodes_.reserve(n);
  for (auto* rows : {&node_rows_, &line_rows_}) rows->reserve(cells + 1);
  lines_.reserve(3 * n);
  line_of_.reserve(2 * n + n / 2);
  taken_.reserve(2 * n + n / 2);
  halved_.reserve(2 * n + n / 2);
}

void TriangleSurface::rebuild(const ActiveMesh& mesh) {
  triangles_.clear();
  for (const Patch& patch : mesh.patches) {
    const auto& n = patch.nodes;
    if (patch.cell.diagonalRises()) {
      triangles_.push_back({n[0], n[1], n[3]});
      triangles_.push_back({n[0], n[3], n[2]});
    } else {
      triangles_.push_back({n[0], n[1], n[2]});
      triangles_.push_back({n[1], n[3], n[2]});
    }
  }
  listNodes(mesh);
  listLines(mesh);
}

void TriangleSurface::listNodes(const ActiveMesh& mesh) {
  nodes_.clear();
  node_rows_.assign(1, 0);
  taken_.assign(mesh.nodes(), 0);
  for (const Patch& patch : mesh.patches) {
    for (const int node : patch.nodes) {
      if (!taken_[node]) nodes_.push_back(node);
      taken_[node] = 1;
    }
    node_rows_.push_back(static_cast<int>(nodes_.size()));
  }
}

void TriangleSurface::listLines(const ActiveMesh& mesh) {
  lines_.clear();
  line_rows_.assign(1, 0);
  line_of_.assign(mesh.edges.size(), -1);
  taken_.assign(mesh.edges.size(), 0);
  halved_.assign(mesh.edges.size(), 0);
  for (std::size_t e = 0; e < mesh.edges.size(); ++e) {
    const int a = mesh.particle[mesh.edges[e].a], b = mesh.particle[mesh.edges[e].b];
    const int middle = (a + b) % 2 == 0 ? mesh.node[(a + b) / 2] : -1;
    const bool finest = b - a == 1 || b - a == mesh.grid.columns;
    halved_[e] = !finest && middle >= 0;
  }
  for (const Patch& patch : mesh.patches) {
    for (const int side : patch.sides) {
      if (!taken_[side] && !halved_[side]) {
        line_of_[side] = lines();
        lines_.push_back({mesh.edges[side].a, mesh.edges[side].b});
      }
      taken_[side] = 1;
    }
    const auto& n = patch.nodes;
    lines_.push_back(patch.cell.diagonalRises() ? Line{n[0], n[3]} : Line{n[1], n[2]});
    line_rows_.push_back(static_cast<int>(lines_.size()));
  }
}

}  // namespace haptic_cloth
