/// Common parts of the peers: command line, run, measurements and files. None of it belongs to the
/// package.
#pragma once

#include <functional>
#include <memory>
#include <nlohmann/json.hpp>
#include <optional>
#include <stdexcept>
#include <string>
#include <vector>

#include "haptic_cloth/scene.h"

namespace haptic_cloth {
namespace peers {

/// A simulator of the same scene by another method.
class Peer {
 public:
  virtual ~Peer() = default;

  /// Advances by frame() with the device at `device` [m] at its end; null: no probe.
  virtual void step(const Vec3* device, const Vec3& device_velocity) = 0;

  /// Time covered by one call of step() [s].
  virtual double frame() const = 0;

  /// Positions of all I·J particles, index j·I + i [m].
  virtual void positions(std::vector<Vec3>& positions) const = 0;

  /// Position of the probe's sphere [m], and force of the cloth on it over the last frame [N].
  virtual Vec3 probe() const = 0;
  virtual Vec3 probeForce() const = 0;

  /// Crossings and total energy [J] of the method's own surface, if it is not the finest mesh.
  struct OwnMeasure {
    int crossings;
    double energy;
  };
  virtual std::optional<OwnMeasure> ownMeasure() const { return {}; }

  /// Further entries for the summary, about the method.
  virtual nlohmann::json details() const = 0;
};

/// Thrown if the peer cannot continue with its present step.
struct Unstable : std::runtime_error {
  using std::runtime_error::runtime_error;
};

/// Common arguments; 0: chosen by the program.
struct Arguments {
  std::string scene, out, solver;
  std::vector<std::string> overrides;
  double step = 0.0;   ///< [s]
  double limit = 0.0;  ///< wall time of all steps after which the run ends early [s]; 0: none
  int iterations = 0, newton = 0, substeps = 0;
};

/// Flat initial shape of a scene, index j·I + i [m].
std::vector<Vec3> flatCloth(const Scene& scene);

/// Mass of each particle [kg], a quarter of each cell around it.
std::vector<double> particleMasses(const Scene& scene);

/// Whether each particle is pinned.
std::vector<char> pinnedParticles(const Scene& scene);

/// A particle held by a pin that moves.
struct MovedParticle {
  int particle;
  Pin pin;
  Vec3 start;  ///< position in the flat cloth [m]

  Vec3 position(double time) const;
};
std::vector<MovedParticle> movedParticles(const Scene& scene);

/// Whether the scene's first probe is closed at a time [s].
bool grasps(const Scene& scene, double time);

/// Particles that the first probe takes when it closes at `place` [m]: the corners of all cells of which a
/// point touches it.
std::vector<int> touchedParticles(const Scene& scene, const std::vector<Vec3>& positions, const Vec3& place);

/// Position of an obstacle on its path at a time [s].
Vec3 obstaclePosition(const Obstacle& obstacle, double time);

/// Slope of a law from zero to s, on the middle line of its loop; |s| is kept at or above `least`.
double secant(const Loop& law, double s, double least);

/// Parses the command line, loads the scene, runs the peer to the scene's stop time and writes
/// summary.json, particles.csv and probe.csv. @return exit status of the program
using MakePeer = std::function<std::unique_ptr<Peer>(const Scene&, const Arguments&)>;
int runPeer(int argc, char** argv, const char* name, const char* description, const MakePeer& make);

}  // namespace peers
}  // namespace haptic_cloth
