#include "fuzz/recording_reader.h"

#include <sstream>
#include <vector>

#include "fuzz/readers.h"
#include "haptic_cloth/scene.h"
#include "haptic_cloth/simulation.h"
#include "sim/recording.h"

namespace haptic_cloth {
namespace {

constexpr int kSteps = 3;              // enough to use every input
constexpr int kMostIterations = 1000;  // more may take hours

void checkCloth(const Simulation& simulation) {
  validateScene(simulation.scene(), "accepted, but");
  std::vector<Vec3> positions;
  simulation.positions(positions);
  for (const Vec3& position : positions) {
    if (!position.allFinite()) throw BrokenPromise("the cloth is not finite");
  }
}

}  // namespace

bool readRecordingBytes(const std::string& bytes) {
  Simulation simulation(parseScene(kTestedScene, kOrigin, "."));
  const bool whole = bytes.rfind("haptic_cloth", 0) == 0;
  std::string recording;
  if (!whole) {
    for (const std::string& line : recorded::header(simulation)) recording += line + '\n';
  }
  std::istringstream text(recording + bytes);
  return accepts([&] {
    Replay replay(text, kOrigin, simulation);
    int steps = 0;
    for (int length = 1; replay.next(simulation, length);) {
      const bool quick = simulation.scene().solver.minimizer.max_iterations <= kMostIterations;
      if (quick && ++steps <= kSteps) simulation.step(length);
    }
    checkCloth(simulation);
  });
}

}  // namespace haptic_cloth
