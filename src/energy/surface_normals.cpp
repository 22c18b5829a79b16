#include "energy/surface_normals.h"

#include "simd/kernels.h"

namespace haptic_cloth {

SurfaceNormals::SurfaceNormals(const ActiveMesh& mesh, bool of_patches) : of_patches_(of_patches) {
  nodes_.reserve(mesh.grid.particles());
  patches_.reserve(static_cast<int>(mesh.patches.capacity()));
}

void SurfaceNormals::update(const ActiveMesh& mesh, const Field& positions) {
  const int patches = static_cast<int>(mesh.patches.size());
  patches_.resize(patches);
  kernels().patchNormals(mesh.patch_corners.data(), static_cast<int>(mesh.patch_corners.size()),
                         positions.arrays(), patches_.arrays());
  nodes_.clear(mesh.nodes());
  for (int c = 0; c < 3; ++c) {
    const auto& of_patch = patches_.coordinate(c);
    auto& of_node = nodes_.coordinate(c);
    for (int k = 0; k < patches; ++k) {
      for (const int corner : mesh.patches[k].nodes) of_node[corner] += of_patch[k];
    }
  }
  kernels().normalise(mesh.nodes(), nodes_.arrays());
  if (of_patches_) kernels().normalise(patches, patches_.arrays());
}

void SurfaceNormals::serialize(Archive& archive) {
  archive("normals", nodes_);
  if (of_patches_) archive("patch_normals", patches_);
}

}  // namespace haptic_cloth
