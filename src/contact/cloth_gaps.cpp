#include "contact/cloth_gaps.h"

#include "shape/solid_lanes.h"
#include "simd/kernels.h"

namespace haptic_cloth {

void Distances::reserve(int points) {
  gaps.reserve(padded(points));
  normals.reserve(points);
}

void Distances::measure(const Solid& solid, int count, const Field& points, Team& team) {
  gaps.resize(padded(count));
  normals.resize(count);
  const SolidLanes lanes = solid.lanes();
  const auto part = [&](int begin, int end) {
    const ConstArrays at = points.arrays();
    const MutableArrays to = normals.arrays();
    kernels().solidDistances(lanes, end - begin, {at.x + begin, at.y + begin, at.z + begin},
                             gaps.data() + begin, {to.x + begin, to.y + begin, to.z + begin});
  };
  team.forRange(count, part);
}

ClothGaps::ClothGaps(const Grid& grid) {
  nodes_.reserve(grid.particles());
  margins_.reserve(padded(grid.cells()));
}

void ClothGaps::measure(const Solid& solid, double range, const ActiveMesh& mesh, const Field& nodes,
                        const std::vector<double>& reach, Team& team) {
  nodes_.measure(solid, nodes.size(), nodes, team);
  const int patches = kPack * static_cast<int>(mesh.patch_corners.size());
  margins_.resize(patches);
  const auto margins = [&](int begin, int end) {
    kernels().patchMargins(mesh.patch_corners.data() + begin / kPack, (end - begin) / kPack, range,
                           nodes.arrays(), reach.data(), nodes_.gaps.data(), nodes_.normals.arrays(),
                           margins_.data() + begin);
  };
  team.forRange(patches, margins);
}

double ClothGaps::normalTurn(const Patch& patch, int c, int d) const {
  return (nodes_.normals[patch.nodes[c]] - nodes_.normals[patch.nodes[d]]).norm();
}

}  // namespace haptic_cloth
