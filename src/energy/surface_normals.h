/// Surface normals, held over a step so that bending and twist have a potential.
#pragma once

#include <vector>

#include "mesh/active_mesh.h"
#include "mesh/field.h"
#include "state/archive.h"

namespace haptic_cloth {

class SurfaceNormals {
 public:
  /// Reserves memory for the finest mesh. @param of_patches patches need normals too
  SurfaceNormals(const ActiveMesh& mesh, bool of_patches);

  /// Sets the normals for some positions. That of a node has the direction of a sum: the normals of its
  /// cells, which count alike, and at a sharp fold, where these cancel, the curvature vectors of its triples.
  void update(const ActiveMesh& mesh, const Field& positions);

  /// Triples that turn by more than 90 degrees at these positions.
  const std::vector<int>& sharpFolds() const { return sharp_folds_; }

  Vec3 node(int node) const { return nodes_[node]; }
  Vec3 patch(int patch) const { return patches_[patch]; }

  ConstArrays nodes() const { return nodes_.arrays(); }
  ConstArrays patches() const { return patches_.arrays(); }

  void serialize(Archive& archive);

 private:
  void addBends(const ActiveMesh& mesh, const Field& positions);

  bool of_patches_;
  Field nodes_;
  Field bends_;    ///< what the triples add to the normals of their nodes
  Field patches_;  ///< unit vectors only if patches need normals
  std::vector<int> sharp_folds_;
};

/// Place and shape of the cloth, as the elements see it.
struct Surface {
  const Field& x;  ///< positions of the nodes [m]
  const SurfaceNormals& normals;
};

}  // namespace haptic_cloth
