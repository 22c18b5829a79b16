/// Cloth that starts in layers above each other, and the laws by which they press.
#pragma once

#include <functional>
#include <vector>

#include "haptic_cloth/scene.h"
#include "haptic_cloth/simulation.h"

namespace haptic_cloth {

/// Layers of one sheet. Each goes back over the one below; a row of cells joins the two.
struct Layers {
  std::vector<int> columns;  ///< particles along warp of each layer, from the lowest to the highest
  int rows = 0;              ///< particles along weft
  double spacing = 0.0;      ///< [m]
  /// Shift of every second layer [cells]; with none, nodes lie exactly above nodes.
  Vec3 aside{0.3, 0.2, 0.0};
};

/// Fabric that resists stretch, but neither bending nor compression nor shear: nothing but contact and
/// weight acts between layers, also where they are joined. @param measured with data of KES-FB3
Fabric slackFabric(double areal_density, bool measured);

/// Layers alone in the world, without air; the first warp particle of the lowest is at x = 0.
Scene layersScene(const Layers& layers, const Fabric& fabric);

/// Layers on a floor and a frictionless sphere of 0.1 m that presses them slowly; their folds hardly push
/// themselves open. @param measured with data of KES-FB3
Scene layersUnderSphere(const Layers& layers, bool measured);

/// Pins the borders of all layers.
void pinBorders(Scene& scene, const Layers& layers);

/// Place of a particle in flat layers [m]. @param heights of the layers [m]
Vec3 placeInLayers(const Layers& layers, const std::vector<double>& heights, int i, int j);

/// Position or velocity of each particle (i, j).
using ByParticle = std::function<Vec3(int i, int j)>;

/// Puts a cloth that has made no step elsewhere. @param place [m]  @param velocity [m/s]; empty: at rest
/// @pre finest mesh
void placeCloth(Simulation& simulation, const ByParticle& place, const ByParticle& velocity = {});

/// Distance of two layers under a pressure [Pa], by bisection of CompressionLaw [m].
double layerDistance(const Fabric& fabric, double pressure);

/// Distance of cloth from a solid under a pressure [Pa], by bisection of ContactLaw [m].
double solidDistance(const Fabric& fabric, double pressure);

/// Force of a sphere on layers on a floor, by the height of its lowest point above the floor: ∫ p dA, with
/// p that of the laws in series: of sphere and cloth, between layers, of cloth and floor. Membrane forces
/// and slopes, below 0.15, are left out.
double pressedLayers(const Fabric& fabric, int layers, double radius, double lowest);

}  // namespace haptic_cloth
