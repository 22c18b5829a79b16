#include "support/layers.h"

#include <algorithm>
#include <cmath>
#include <cstring>

#include "contact/compression_law.h"
#include "contact/contact_law.h"
#include "support/scenes.h"
#include "support/state_cases.h"

namespace haptic_cloth {
namespace {

double readDouble(const std::string& bytes, std::size_t index) {
  double number = 0.0;
  std::memcpy(&number, &bytes[index * sizeof(number)], sizeof(number));
  return number;
}

void writeDouble(std::string& bytes, std::size_t index, double number) {
  std::memcpy(&bytes[index * sizeof(number)], &number, sizeof(number));
}

/// Distance below `range` at which a law has a pressure [Pa].
template <class Law>
double distanceUnder(const Law& law, double pressure) {
  double low = 0.0, high = law.range();
  for (int k = 0; k < 100; ++k) {
    const double middle = 0.5 * (low + high);
    (law(middle).pressure > pressure ? low : high) = middle;
  }
  return 0.5 * (low + high);
}

}  // namespace

Fabric slackFabric(double areal_density, bool measured) {
  LinearFabric linear;
  linear.areal_density = areal_density;
  linear.stiffness = 100.0;
  linear.compression = 1e-6;
  linear.shear_modulus = 1e-6;
  if (measured) linear.measured = Compression{linear.thickness, 0.7 * linear.thickness, 0.35};
  return makeFabric(linear);
}

Scene layersScene(const Layers& layers, const Fabric& fabric) {
  int columns = 0;
  for (const int count : layers.columns) columns += count;
  Scene scene = sheetScene(fabric, columns, layers.rows, (columns - 1) * layers.spacing,
                           (layers.rows - 1) * layers.spacing);
  scene.cloth.pose.position = Vec3(0.5 * (columns - 1) * layers.spacing, 0.0, 1.0);
  return scene;
}

Scene layersUnderSphere(const Layers& layers, bool measured) {
  LinearFabric linear;
  linear.stiffness = 200.0;
  linear.compression = 1e-3;
  linear.rigidity = 1e-7;
  linear.shear_modulus = 5.0;
  if (measured) linear.measured = slackFabric(linear.areal_density, true).compression;
  Scene scene = layersScene(layers, makeFabric(linear));
  scene.obstacles = {Obstacle()};
  ProbeOptions& probe = scene.probes[0];
  probe.radius = 0.1;
  probe.friction = 0.0;
  quasiStatic(scene, 30.0, 2e-3, 0.02);  // of the weight of the layers, 5 mN; tests feel more than 0.1 N
  return scene;
}

void pinBorders(Scene& scene, const Layers& layers) {
  int i0 = 0;
  for (const int columns : layers.columns) {
    const int i1 = i0 + columns - 1, last = layers.rows - 1;
    pin(scene, i0, i0, 0, last);
    pin(scene, i1, i1, 0, last);
    pin(scene, i0, i1, 0, 0);
    pin(scene, i0, i1, last, last);
    i0 = i1 + 1;
  }
}

Vec3 placeInLayers(const Layers& layers, const std::vector<double>& heights, int i, int j) {
  std::size_t layer = 0;
  int column = 0, from = i;  // column above the lowest layer
  double step = 1.0;
  while (from >= layers.columns[layer]) {
    from -= layers.columns[layer];
    column += static_cast<int>(step) * (layers.columns[layer] - 1);
    step = -step;
    ++layer;
  }
  const Vec3 aside = layer % 2 == 0 ? Vec3(Vec3::Zero()) : layers.aside;
  const Vec3 place(column + step * from, j - 0.5 * (layers.rows - 1), heights[layer] / layers.spacing);
  return layers.spacing * (place + aside);
}

void placeCloth(Simulation& simulation, const ByParticle& place, const ByParticle& velocity) {
  const int columns = simulation.scene().cloth.particles[kWarp];
  std::vector<Vec3> flat;
  simulation.positions(flat);
  std::vector<StateEntry> entries = stateEntries(simulation.saveState());
  const auto entry = [&](const std::string& name) -> std::string& {
    return std::find_if(entries.begin(), entries.end(), [&](const StateEntry& e) { return e.name == name; })
        ->bytes;
  };
  // Node n is the particle at the same place.
  std::vector<int> particle;
  const Vec3 warp = flat[1] - flat[0], weft = flat[columns] - flat[0];
  for (std::size_t n = 0; n < flat.size(); ++n) {
    const Vec3 node(readDouble(entry("nodes.x"), n), readDouble(entry("nodes.y"), n),
                    readDouble(entry("nodes.z"), n));
    const long i = std::lround((node - flat[0]).dot(warp) / warp.squaredNorm()),
               j = std::lround((node - flat[0]).dot(weft) / weft.squaredNorm());
    particle.push_back(static_cast<int>(j * columns + i));
  }
  const auto set = [&](const std::string& particles, const std::string& nodes, const ByParticle& value) {
    for (std::size_t n = 0; n < flat.size(); ++n) {
      const int p = particle[n];
      const Vec3 at = value(p % columns, p / columns);
      for (int c = 0; c < 3; ++c) {
        writeDouble(entry(particles), 3 * p + c, at[c]);
        writeDouble(entry(nodes + "." + "xyz"[c]), n, at[c]);
      }
    }
  };
  set("particles.position", "nodes", place);
  if (velocity) set("particles.velocity", "velocities", velocity);
  simulation.loadState(sealState(entries), "placed cloth");
}

double layerDistance(const Fabric& fabric, double pressure) {
  return distanceUnder(CompressionLaw(fabric), pressure);
}

double solidDistance(const Fabric& fabric, double pressure) {
  return distanceUnder(ContactLaw(fabric.thickness), pressure);
}

double pressedLayers(const Fabric& fabric, int layers, double radius, double lowest) {
  const auto pressureAt = [&](double distance) {
    double low = 0.0, high = 1e7;
    for (int k = 0; k < 80; ++k) {
      const double p = 0.5 * (low + high);
      (2.0 * solidDistance(fabric, p) + (layers - 1) * layerDistance(fabric, p) > distance ? low : high) = p;
    }
    return 0.5 * (low + high);
  };
  constexpr int kParts = 200;
  const double thickness = (layers + 1) * fabric.thickness;
  if (lowest >= thickness) return 0.0;
  const double most = std::sqrt(radius * radius - std::pow(radius - (thickness - lowest), 2));
  double sum = 0.0;
  for (int k = 0; k < kParts; ++k) {
    const double r = (k + 0.5) / kParts * most;
    sum +=
        2.0 * EIGEN_PI * r * most / kParts * pressureAt(lowest + radius - std::sqrt(radius * radius - r * r));
  }
  return sum;
}

}  // namespace haptic_cloth
