/// Surface of the cloth as triangles: two for each leaf.
#pragma once

#include <array>
#include <vector>

#include "mesh/active_mesh.h"

namespace haptic_cloth {

/// Triangles of the leaves (Cell::diagonalRises()), and the lines that bound them. Hanging nodes lie on
/// the sides of triangles, so the surface has no gaps. Lines are the sides of leaves, halved where a node
/// hangs, and diagonals.
class TriangleSurface {
 public:
  using Triangle = std::array<int, 3>;  ///< nodes
  struct Line {
    int a, b;  ///< nodes
  };

  explicit TriangleSurface(const Grid& grid);

  void rebuild(const ActiveMesh& mesh);

  const Triangle& triangle(int patch, int half) const { return triangles_[2 * patch + half]; }

  /// Nodes and lines that belong to a patch: each belongs to one of the patches around it.
  struct Range {
    int begin, end;
  };
  Range nodesOf(int patch) const { return {node_rows_[patch], node_rows_[patch + 1]}; }
  Range linesOf(int patch) const { return {line_rows_[patch], line_rows_[patch + 1]}; }
  int node(int k) const { return nodes_[k]; }
  const Line& line(int k) const { return lines_[k]; }

  int lines() const { return static_cast<int>(lines_.size()); }
  int lineOf(int edge) const { return line_of_[edge]; }  ///< that is an edge of the mesh; -1 if it is halved
  int diagonal(int patch) const { return line_rows_[patch + 1] - 1; }  ///< line between its triangles

 private:
  void listNodes(const ActiveMesh& mesh);
  void listLines(const ActiveMesh& mesh);

  std::vector<Triangle> triangles_;
  std::vector<int> nodes_, node_rows_, line_rows_;
  std::vector<Line> lines_;
  std::vector<int> line_of_;
  std::vector<char> taken_;   ///< scratch: of nodes, and of the mesh's edges
  std::vector<char> halved_;  ///< scratch: edges with a hanging node in the middle
};

}  // namespace haptic_cloth
