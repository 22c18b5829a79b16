#include "fuzz/readers.h"

#include <cctype>
#include <cmath>
#include <sstream>
#include <vector>

#include "haptic_cloth/error.h"
#include "haptic_cloth/fabric.h"
#include "haptic_cloth/scene.h"

namespace haptic_cloth {
namespace {

constexpr std::size_t kLongestMessage = 10000;

// Rounding of the sums in a law, relative to its largest force.
constexpr double kRounding = 1e-9;

void require(bool holds, const std::string& what) {
  if (!holds) throw BrokenPromise(what);
}

void checkMessage(const std::string& what) {
  require(what.rfind(kOrigin, 0) == 0 || what.rfind("--set", 0) == 0, "names no source: " + what);
  require(what.find(": ") != std::string::npos && what.find(": ") + 2 < what.size(),
          "names no rule: " + what);
  require(what.size() <= kLongestMessage, "is too long: " + what.substr(0, 200));
  for (const char c : what) {
    require(std::iscntrl(static_cast<unsigned char>(c)) == 0, "is not one line of text: " + what);
  }
}

/// Checks a curve. @return the largest |force| at the ends of its intervals
double checkCurve(const Curve& curve, const std::string& name) {
  double largest = 0.0;
  for (const Curve::Interval& interval : curve.intervals()) {
    const bool finite = std::isfinite(interval.begin) && std::isfinite(interval.potential) &&
                        std::isfinite(interval.force) && std::isfinite(interval.slope);
    require(finite, name + " is not finite");
    largest = std::max(largest, std::abs(interval.force));
  }
  for (const Curve::Interval& interval : curve.intervals()) {
    require(interval.slope / curve.inverseStep() >= -kRounding * largest, name + " falls");
  }
  return largest;
}

void checkLoop(const Loop& loop, const std::string& name) {
  const double largest = checkCurve(loop.upper(), name + ", upper branch");
  checkCurve(loop.lower(), name + ", lower branch");
  for (const Curve::Interval& interval : loop.lower().intervals()) {
    const double upper = loop.upper()(interval.begin).force;
    require(interval.force <= upper + kRounding * largest, name + ": its branches cross");
  }
  require(std::isfinite(loop.initialPlay()), name + ": no play to start with");
  const Loop::Step step = loop.begin(loop.initialPlay());
  for (const double s : {-0.1, 0.0, 1e-6, 0.01, 0.1}) {
    const Loop::Point point = loop(step, s);
    require(std::isfinite(point.potential) && std::isfinite(point.force) && std::isfinite(point.slope),
            name + " is not finite at " + std::to_string(s));
  }
}

void checkFabric(const Fabric& fabric) {
  require(fabric.areal_density > 0.0 && fabric.thickness > 0.0, "a fabric without mass or thickness");
  require(std::isfinite(fabric.twist_rigidity) && fabric.twist_rigidity >= 0.0, "twist rigidity");
  require(!fabric.source.empty(), "a fabric without a source");
  for (const int d : {0, 1}) {
    checkLoop(fabric.tensile[d], "tensile law");
    checkLoop(fabric.bending[d], "bending law");
  }
  checkLoop(fabric.shear, "shear law");
}

}  // namespace

const char kTestedScene[] = R"(cloth: {fabric: linear, particles: [5, 9], pins: [corner_00, edge_x1]}
obstacles: [{shape: sphere, radius: 0.05}, {name: table, shape: box, size: [1, 1, 0.1]}]
probes: {thumb: {radius: 0.01, path: [[0, 0, 0, 1], [1, 0, 0, 0]]}, index: {shape: capsule, length: 0.02}}
solver: {time_step: 0.002}
)";

bool accepts(const std::function<void()>& read) {
  try {
    read();
  } catch (const InputError& error) {
    checkMessage(error.what());
    return false;
  }
  return true;
}

bool readSceneBytes(const std::string& bytes) {
  return accepts([&] { validateScene(parseScene(bytes, kOrigin, "."), "accepted, but"); });
}

bool readFabricBytes(const std::string& bytes) {
  return accepts([&] { checkFabric(parseFabric(bytes, kOrigin, "cloth")); });
}

bool readOverrideBytes(const std::string& bytes) {
  std::vector<std::string> overrides;
  std::istringstream lines(bytes);
  for (std::string line; std::getline(lines, line);) overrides.push_back(line);
  return accepts([&] { validateScene(parseScene(kTestedScene, kOrigin, ".", overrides), "accepted, but"); });
}

}  // namespace haptic_cloth
