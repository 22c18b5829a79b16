// Limits of speeds, strains and forces that follow from a run's own inputs.
#include <algorithm>
#include <cmath>

#include "support/torture.h"

namespace haptic_cloth {
namespace {

/// Energy of the law at a strain, which may be negative [J/m²].
double energyAt(const Loop& law, double strain) {
  return law.upper()(strain).potential - law.upper()(0.0).potential;
}

/// Smallest strain at which `reached` is true; it must stay true for larger strains.
template <class Reached>
double leastStrain(const Reached& reached) {
  double low = 0.0, high = 1e-3;
  while (!reached(high) && high < 1e3) high *= 2.0;
  for (int k = 0; k < 60; ++k) {
    const double middle = 0.5 * (low + high);
    (reached(middle) ? high : low) = middle;
  }
  return high;
}

/// Speed from inputs and fall [m/s].
double motionOf(const TortureResult& result, const Scene& scene) {
  return 2.0 * result.driven + std::sqrt(4.0 * scene.gravity.norm() * result.sunk);
}

/// Width of the cloth that carries the load [m]. With pins it is that of a corner's threads, half a
/// cell each; otherwise the width under the thinnest probe, or the whole cloth without probes.
double carryingWidth(const Scene& scene) {
  const auto& [columns, rows] = scene.cloth.particles;
  const auto& [length, width] = scene.cloth.size;
  if (!scene.cloth.pins.empty()) return std::min(length / (columns - 1), width / (rows - 1));
  double least = std::min(length, width);
  for (const ProbeOptions& probe : scene.probes) least = std::min(least, 2.0 * probe.radius);
  return least;
}

}  // namespace

double speedLimit(const TortureResult& result, const Scene& scene) {
  double stored = 0.0;
  for (const Loop& law : scene.cloth.fabric.tensile)
    stored += std::max(energyAt(law, result.stretched), energyAt(law, -result.shortened));
  return motionOf(result, scene) + 2.0 * std::sqrt(2.0 * stored / scene.cloth.fabric.areal_density);
}

double rebound(const Fabric& fabric, double strain) {
  double limit = strain;
  for (const Loop& law : fabric.tensile) {
    const double stored = energyAt(law, strain);
    limit = std::max(limit, leastStrain([&](double s) { return energyAt(law, -s) >= stored; }));
  }
  return limit;
}

double strainLimit(const TortureResult& result, const Scene& scene, bool pushed) {
  const Fabric& fabric = scene.cloth.fabric;
  const double speed = 2.0 * motionOf(result, scene), moving = 0.5 * fabric.areal_density * speed * speed;
  const double weight =
      fabric.areal_density * scene.cloth.size[0] * scene.cloth.size[1] * scene.gravity.norm();
  const double force = static_cast<double>(scene.probes.size()) * result.force + 2.0 * weight;
  double limit = 0.0;
  for (const Loop& law : fabric.tensile) {
    const auto carries = [&](double s) {
      return std::abs(law.upper()(s).force) * carryingWidth(scene) >= force;
    };
    const double pulled = leastStrain([&](double s) { return carries(s) && (!pushed || carries(-s)); });
    const double stopped = leastStrain([&](double s) { return energyAt(law, -s) >= moving; });
    limit = std::max(limit, pulled + stopped);
  }
  return limit;
}

}  // namespace haptic_cloth
