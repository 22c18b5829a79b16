/// Cloth that lies in layers, in positions that a test sets, for tests of self-contact alone.
#pragma once

#include <cmath>
#include <random>
#include <vector>

#include "contact/self_contact.h"
#include "energy/surface_normals.h"
#include "haptic_cloth/fabric.h"
#include "mesh/triangle_surface.h"

namespace haptic_cloth {

constexpr double kThickness = 1e-3, kSpacing = 4e-3;  // [m]
constexpr double kSlip = 1e-6;                        // [m]

inline Grid gridOf(int columns, int rows, int levels) { return {columns, rows, levels, kSpacing, kSpacing}; }

inline CompressionLaw law(double thickness = kThickness) {
  Fabric fabric;
  fabric.thickness = thickness;
  return CompressionLaw(fabric);
}

/// Law of a fabric that KES-FB3 found hard.
inline CompressionLaw hardLaw() {
  Fabric fabric;
  fabric.compression = Compression{kThickness, 0.9 * kThickness, 0.2};
  return CompressionLaw(fabric);
}

/// Cloth with self-contact, in positions that a test sets.
struct Folded {
  Folded(const Grid& grid, const LeafMesh& leaves, double friction, const CompressionLaw& between = law())
      : mesh(leaves, 0.2), contact(grid, {between, friction}, kSlip), surface(grid) {
    contact.rebuild(mesh);
    surface.rebuild(mesh);
    x.resize(mesh.nodes());
    for (int n = 0; n < mesh.nodes(); ++n) x.set(n, flat(n));
    still.clear(mesh.nodes());
    reach.assign(mesh.nodes(), 0.0);
    dented.assign(mesh.patches.size(), 0);
  }
  explicit Folded(const Grid& grid, double friction = 0.0, const CompressionLaw& between = law())
      : Folded(grid, LeafMesh(grid, {}, 0), friction, between) {}

  Vec3 flat(int n) const {
    return {mesh.grid.column(mesh.particle[n]) * kSpacing, mesh.grid.row(mesh.particle[n]) * kSpacing, 0.0};
  }
  /// Places all nodes. @param place position [m] of a point of the flat cloth [m]
  template <class Place>
  void place(const Place& place) {
    for (int n = 0; n < mesh.nodes(); ++n) x.set(n, place(flat(n)));
    mesh.interpolateGhosts(x);
  }
  void collect() {
    SurfaceNormals normals(mesh, false);
    normals.update(mesh, x);
    contact.collect(mesh, x, normals.nodes(), {still, reach}, dented);
  }
  void remember() {
    SurfaceNormals normals(mesh, false);
    normals.update(mesh, x);
    contact.rememberFriction(mesh, normals.nodes());
  }
  Field gradient() {
    Field sum;
    sum.clear(mesh.nodes());
    contact.noteMotion(x);
    contact.evaluate(0, contact.size(), x);
    contact.sumForces(mesh.nodes());
    contact.addGradient(0, mesh.nodes(), sum);
    return sum;
  }
  double energy(const Field& at) {
    contact.noteMotion(at);
    const ContactEnergy energy = contact.evaluate(0, contact.size(), at);
    return energy.contact + energy.friction;
  }

  ActiveMesh mesh;
  SelfContact contact;
  TriangleSurface surface;
  Field x, still;
  std::vector<double> reach;
  std::vector<char> dented;  ///< by patch
};

/// Mesh of mixed levels.
inline LeafMesh mixedLeaves(const Grid& grid, unsigned seed) {
  LeafMesh leaves(grid, {}, grid.levels);
  std::mt19937 random(seed);
  std::vector<Cell> done;
  for (int k = 0; k < 6; ++k) {
    leaves.split(leaves.leafAt(random() % (grid.columns - 1), random() % (grid.rows - 1)), done);
  }
  return leaves;
}

/// Adds noise to all nodes but hanging ones. @param size standard deviation [m]
inline void shake(Folded& cloth, std::mt19937& random, double size) {
  std::normal_distribution<double> noise(0.0, size);
  for (int n = 0; n < cloth.mesh.active(); ++n)
    cloth.x.add(n, Vec3(noise(random), noise(random), noise(random)));
  cloth.mesh.interpolateGhosts(cloth.x);
}

/// Sheet that turns back over itself around the line at x = `fold`, with a gap between the layers.
inline Vec3 hairpin(const Vec3& at, double fold, double gap) {
  const double radius = 0.5 * gap, along = at.x() - fold, turn = along / radius;
  if (along <= 0.0) return at;
  if (turn < EIGEN_PI) return {fold + radius * std::sin(turn), at.y(), radius * (1.0 - std::cos(turn))};
  return {fold - (along - static_cast<double>(EIGEN_PI) * radius), at.y(), gap};
}

}  // namespace haptic_cloth
