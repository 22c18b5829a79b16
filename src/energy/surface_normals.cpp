#include "energy/surface_normals.h"

#include <algorithm>

#include "simd/kernels.h"

namespace haptic_cloth {

SurfaceNormals::SurfaceNormals(const ActiveMesh& mesh, bool of_patches) : of_patches_(of_patches) {
  nodes_.reserve(mesh.grid.particles());
  bends_.reserve(static_cast<int>(mesh.triples.capacity()));
  sharp_folds_.reserve(mesh.triples.capacity());
  patches_.reserve(static_cast<int>(mesh.patches.capacity()));
}

void SurfaceNormals::update(const ActiveMesh& mesh, const Field& positions) {
  const int patches = static_cast<int>(mesh.patches.size());
  patches_.resize(patches);
  kernels().patchNormals(mesh.patch_corners.data(), static_cast<int>(mesh.patch_corners.size()),
                         positions.arrays(), patches_.arrays());
  nodes_.clear(mesh.nodes());
  for (int k = 0; k < patches; ++k) {
    const Vec3 normal = patches_[k] / (2.0 * mesh.patches[k].area);
    for (const int corner : mesh.patches[k].nodes) nodes_.add(corner, normal);
  }
  addBends(mesh, positions);
  kernels().normalise(mesh.nodes(), nodes_.arrays());
  if (of_patches_) kernels().normalise(patches, patches_.arrays());
}

/// Adds 4 |β|² β for each triple, with β = ± ½ l κ and κ its curvature vector, towards the side of the cells'
/// normals. If these turn by φ at the node, their sum has the length 4 cos(φ/2), and |β| is sin(φ/2): this
/// is next to nothing on a smooth surface, and all there is where the sides of a fold lie on each other.
/// Where the arms are stretched differently, κ has a part along the thread, which is not its curvature.
void SurfaceNormals::addBends(const ActiveMesh& mesh, const Field& positions) {
  constexpr double kCells = 4.0, kSharp = 0.5;  // the latter: sin² 45°
  sharp_folds_.clear();
  bends_.resize(static_cast<int>(mesh.triples.size()));
  for (int t = 0; t < bends_.size(); ++t) {
    const Triple& triple = mesh.triples[t];
    const double half = 0.5 * triple.length;
    const Vec3 centre = positions[triple.c];
    const Vec3 along = half * (triple.right * (positions[triple.r] - centre) +
                               triple.left * (centre - positions[triple.l]));  // cos(φ/2) long
    Vec3 bend = half * triple.bent(positions);
    bend -= bend.dot(along) / std::max(1.0, along.squaredNorm()) * along;
    if (bend.squaredNorm() > kSharp) sharp_folds_.push_back(t);
    bends_.set(t, (nodes_[triple.c].dot(bend) < 0.0 ? -kCells : kCells) * bend.squaredNorm() * bend);
  }
  for (int t = 0; t < bends_.size(); ++t) nodes_.add(mesh.triples[t].c, bends_[t]);
}

void SurfaceNormals::serialize(Archive& archive) {
  archive("normals", nodes_);
  if (of_patches_) archive("patch_normals", patches_);
}

}  // namespace haptic_cloth
