/// What the bench's peers have in common: command line, run, measures and files. None of it is in the
/// package.
#pragma once

#include <functional>
#include <memory>
#include <nlohmann/json.hpp>
#include <stdexcept>
#include <string>
#include <vector>

#include "haptic_cloth/scene.h"

namespace haptic_cloth {
namespace peers {

/// A simulator of the same scene by other means.
class Peer {
 public:
  virtual ~Peer() = default;

  /// Advances by frame() with the device at `device` [m] at its end; null: no probe.
  virtual void step(const Vec3* device, const Vec3& device_velocity) = 0;

  /// Time between two looks from outside [s].
  virtual double frame() const = 0;

  /// Of all I·J particles, index j·I + i [m].
  virtual void positions(std::vector<Vec3>& positions) const = 0;

  /// Of the probe's sphere [m], and force of the cloth on it over the last frame [N].
  virtual Vec3 probe() const = 0;
  virtual Vec3 probeForce() const = 0;

  /// What else the summary should say of the method.
  virtual nlohmann::json details() const = 0;
};

/// The peer cannot go on with its present step.
struct Unstable : std::runtime_error {
  using std::runtime_error::runtime_error;
};

/// Common arguments; 0: as the program decides.
struct Arguments {
  std::string scene, out, solver;
  std::vector<std::string> overrides;
  double step = 0.0;  ///< [s]
  int iterations = 0, newton = 0, substeps = 0;
};

/// The flat start of a scene, index j·I + i [m].
std::vector<Vec3> flatCloth(const Scene& scene);

/// Mass of each particle [kg], a quarter of each cell around it.
std::vector<double> particleMasses(const Scene& scene);

/// Which particles a scene pins.
std::vector<char> pinnedParticles(const Scene& scene);

/// Slope of a law from zero to s, on the middle line of its loop; s is kept off zero by `least`.
double secant(const Loop& law, double s, double least);

/// Parses the command line, loads the scene, runs the peer to the scene's stop time and writes summary.json,
/// particles.csv and probe.csv. @return the program's exit status
using MakePeer = std::function<std::unique_ptr<Peer>(const Scene&, const Arguments&)>;
int runPeer(int argc, char** argv, const char* name, const char* description, const MakePeer& make);

}  // namespace peers
}  // namespace haptic_cloth
