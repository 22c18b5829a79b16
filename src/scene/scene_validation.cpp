#include "scene/scene_validation.h"

#include <algorithm>
#include <cctype>
#include <cmath>
#include <locale>
#include <sstream>

#include "fabric/fabric_limits.h"
#include "haptic_cloth/error.h"
#include "shape/shapes.h"
#include "state/number_text.h"

namespace haptic_cloth {
namespace {

constexpr double kMostParticles = 1 << 24;  ///< so that every index and offset fits an int
/// Largest number of particles times solids: memory is reserved for each pair.
constexpr double kMostContacts = 1 << 26;
constexpr std::size_t kMostProbes = 64, kMostObstacles = 1024, kMostPins = 4096;
constexpr double kFinestProbe = 0.02;  ///< smallest radius of a probe / finest spacing [-]
constexpr double kMostSlender = 1e5;   ///< largest spacing of particles / thickness of the fabric [-]
constexpr double kMostSides = 10.0;    ///< largest radius of a probe / longer side of the cloth [-]

/// Prints a count that is far too large with six digits.
std::string rounded(double count) {
  std::ostringstream text;
  text.imbue(std::locale::classic());
  text << count;
  return text.str();
}

std::string toText(double value) { return shortestText(value); }

template <class T>
std::string toText(const T& value) {
  std::ostringstream text;
  text.imbue(std::locale::classic());
  text << value;
  return text.str();
}

/// Named rules; each throws if it is broken.
class Check {
 public:
  explicit Check(const Locate& locate) : locate_(locate) {}

  template <class T>
  void that(bool holds, const std::string& key, const T& value, const std::string& rule) const {
    if (holds) return;
    throw InputError(locate_(key), key, toText(value), rule);
  }

  void options(const std::string& prefix, const Options& options) const {
    checkOptions(options, prefix, locate_);
  }
  void positive(const std::string& key, double value) const {
    options("", {{key, field(value), kPositive, "", ""}});
  }
  void count(const std::string& key, std::size_t value, std::size_t most) const {
    that(value <= most, key, std::to_string(value) + " entries", "must have at most " + std::to_string(most));
  }

  std::string placeOf(const std::string& key) const { return locate_(key); }

 private:
  const Locate& locate_;
};

void checkGrid(const Check& check, const ClothOptions& cloth, const AdaptOptions& adapt) {
  const int coarsest = 1 << adapt.levels;
  for (std::size_t d = 0; d < 2; ++d) {
    check.that((cloth.particles[d] - 1) % coarsest == 0, indexed("cloth.particles", d), cloth.particles[d],
               "particles - 1 must be divisible by 2^adapt.levels = " + std::to_string(coarsest));
  }
  const double count = static_cast<double>(cloth.particles[0]) * cloth.particles[1];
  check.that(count <= kMostParticles, "cloth.particles", rounded(count), "the product must be at most 2^24");
  const double spacing =
      std::max(cloth.size[0] / (cloth.particles[0] - 1), cloth.size[1] / (cloth.particles[1] - 1));
  check.that(spacing <= kMostSlender * cloth.fabric.thickness, "cloth.size", spacing,
             "the spacing of particles in m, must be at most 100000 times the fabric's thickness");
}

void checkPins(const Check& check, const ClothOptions& cloth) {
  check.count("cloth.pins", cloth.pins.size(), kMostPins);
  for (std::size_t p = 0; p < cloth.pins.size(); ++p) {
    Pin pin = cloth.pins[p];  // rows point to members that could be written
    const std::string key = indexed("cloth.pins", p);
    const auto range = [&](const std::string& name, int from, int to, int count) {
      check.that(
          from >= 0 && from <= to && to < count, key,
          "[" + std::to_string(from) + ", " + std::to_string(to) + "]",
          name + " must be a range [first, last] with 0 <= first <= last <= " + std::to_string(count - 1));
    };
    range("particles[0]", pin.i0, pin.i1, cloth.particles[0]);
    range("particles[1]", pin.j0, pin.j1, cloth.particles[1]);
    check.options(key + ".", optionsOf(pin));
  }
}

void checkPath(const Check& check, const std::string& prefix, const std::vector<PathPoint>& path) {
  for (std::size_t i = 0; i < path.size(); ++i) {
    const std::string key = indexed(prefix, i);
    const double time = path[i].time;
    const Vec3& position = path[i].position;
    check.that(position.allFinite(), key, position.transpose(), "must be finite");
    check.that(position.cwiseAbs().maxCoeff() <= kMostLength, key, position.transpose(),
               "must be within -1e6 to 1e6");
    check.that(std::isfinite(time), key + "[0]", time, "must be finite");
    check.that(std::abs(time) <= kLargest, key + "[0]", time, "must be within -1e12 to 1e12");
    check.that(i == 0 || time > path[i - 1].time, key + "[0]", time,
               "times must increase strictly from row to row");
  }
}

/// Checks names, which topics and files carry.
template <class Named>
void checkNames(const Check& check, const std::string& prefix, const std::vector<Named>& items,
                bool required) {
  const auto part = [](char c) { return std::isalnum(static_cast<unsigned char>(c)) != 0 || c == '_'; };
  for (std::size_t i = 0; i < items.size(); ++i) {
    const std::string& name = items[i].name;
    if (name.empty() && !required) continue;
    const bool good = !name.empty() && std::isalpha(static_cast<unsigned char>(name.front())) != 0 &&
                      std::all_of(name.begin(), name.end(), part);
    check.that(good, prefix, name, "a name must be a letter, then letters, digits and underscores");
    for (std::size_t k = 0; k < i; ++k) {
      check.that(items[k].name != name, prefix, name, "a name must not be used twice");
    }
  }
}

/// @param prefix key of the probe
void checkProbe(const Check& check, const std::string& prefix, ProbeOptions& probe,
                const ClothOptions& cloth) {
  check.options(prefix + ".", optionsOf(probe));
  const double smallest = smallestProbeRadius(cloth);
  check.that(probe.radius >= smallest, prefix + ".radius", probe.radius,
             "must be at least " + shortestText(smallest) +
                 " m, a fiftieth of the finest spacing that cloth.size (in metres) and cloth.particles give");
  const double largest = kMostSides * std::max(cloth.size[0], cloth.size[1]);
  check.that(probe.radius <= largest, prefix + ".radius", probe.radius,
             "must be at most " + shortestText(largest) + " m, ten times the longer side of cloth.size");
  checkPath(check, prefix + ".path", probe.path);
  check.that(probe.grasp.empty() || !probe.path.empty(), prefix + ".grasp",
             std::to_string(probe.grasp.size()) + " rows", "needs a path: its times are those of the path");
  for (std::size_t i = 0; i < probe.grasp.size(); ++i) {
    const auto [from, to] = probe.grasp[i];
    check.that(std::isfinite(from) && from < to, indexed(prefix + ".grasp", i), from,
               "must be [from, to] with from < to");
  }
}

/// Checks that a branch of a law nowhere falls, but for rounding.
void checkRises(const Check& check, const std::string& key, const Curve& branch) {
  constexpr double kRounding = 1e-9;
  const std::vector<Curve::Interval>& intervals = branch.intervals();
  double steepest = 0.0;
  for (const Curve::Interval& interval : intervals) steepest = std::max(steepest, interval.slope);
  const auto falls = std::find_if(intervals.begin(), intervals.end(), [&](const Curve::Interval& interval) {
    return !(interval.slope >= -kRounding * steepest);
  });
  if (falls != intervals.end())
    check.that(false, key, falls->slope,
               "the stiffness must not be negative, as it is from " + toText(falls->begin) + " on");
}

void checkLaw(const Check& check, const std::string& key, const Loop& law) {
  checkRises(check, key, law.upper());
  checkRises(check, key, law.lower());
}

/// Refuses cloth that does not keep its length.
void checkTension(const Check& check, const std::string& key, const Loop& law) {
  constexpr double kLong = 100.0;  // beyond what is measured [-]
  const double most = law.upper()(kLong).force;
  check.that(most > 0.0, key, most, "must resist extension: its last force must be > 0");
}

void checkCompression(const Check& check, const Compression& compression, double fabric_thickness) {
  const std::string key = "cloth.fabric.compression.";
  const auto [thickness, pressed, linearity] = compression;
  check.that(thickness >= fabric_thickness / kAlike && thickness <= kAlike * fabric_thickness,
             key + "thickness", thickness, "must be within a factor of 10 of the fabric's thickness");
  check.that(pressed > 0.0 && pressed <= kMostPressed * thickness, key + "pressed_thickness", pressed,
             "must be > 0 and at most 0.99 thickness");
  check.that(linearity >= kLeastLinearity && linearity < 1.0, key + "linearity", linearity,
             "must be >= 0.05 and < 1");
}

/// The rules of fabric files for a fabric that is given in code.
void checkFabric(const Check& check, const Fabric& fabric) {
  const std::string key = "cloth.fabric.";
  check.positive(key + "areal_density", fabric.areal_density);
  check.that(fabric.areal_density <= kHeaviest, key + "areal_density", fabric.areal_density, kHeaviestRule);
  check.positive(key + "thickness", fabric.thickness);
  check.that(fabric.thickness <= kThickest, key + "thickness", fabric.thickness, kThickestRule);
  check.that(fabric.twist_rigidity >= 0.0 && fabric.twist_rigidity <= kLargest, key + "twist_rigidity",
             fabric.twist_rigidity, "must be >= 0 and at most 1e12");
  for (std::size_t d = 0; d < 2; ++d) {
    checkLaw(check, indexed(key + "tensile", d), fabric.tensile[d]);
    checkTension(check, indexed(key + "tensile", d), fabric.tensile[d]);
    checkLaw(check, indexed(key + "bending", d), fabric.bending[d]);
  }
  checkLaw(check, key + "shear", fabric.shear);
  if (fabric.compression) checkCompression(check, *fabric.compression, fabric.thickness);
}

void checkThresholds(const Check& check, const AdaptOptions& adapt) {
  const auto below = [&check](const char* key, double value, const char* bound, double most) {
    const std::string place = check.placeOf(bound);
    check.that(value < most, key, value,
               std::string("must be below ") + bound + " = " + shortestText(most) +
                   (place == check.placeOf(key) ? "" : " of " + place));
  };
  below("adapt.coarsen_below", adapt.coarsen_below, "adapt.refine_above", adapt.refine_above);
  below("adapt.coarsen_below_strain", adapt.coarsen_below_strain, "adapt.refine_above_strain",
        adapt.refine_above_strain);
}

/// @param options by value, as rows point to members that could be written
void checkSteps(const Check& check, StepOptions options) {
  check.options("", optionsOf(options));
  checkThresholds(check, options.adapt);
}

}  // namespace

double smallestProbeRadius(const ClothOptions& cloth) {
  return kFinestProbe *
         std::min(cloth.size[0] / (cloth.particles[0] - 1), cloth.size[1] / (cloth.particles[1] - 1));
}

void checkStepOptions(const StepOptions& options, const std::string& origin) {
  const Locate locate = [&origin](const std::string&) { return origin; };
  checkSteps(Check(locate), options);
}

void checkScene(const Scene& checked, const Locate& locate) {
  const Check check(locate);
  check.count("obstacles", checked.obstacles.size(), kMostObstacles);
  check.count("probes", checked.probes.size(), kMostProbes);
  Scene scene = checked;  // rows point to members that could be written
  check.options("cloth.", optionsOf(scene.cloth));
  check.options("", worldOptions(scene));
  checkSteps(check, stepOptions(scene));
  check.options("stop.", optionsOf(scene.stop));
  checkFabric(check, scene.cloth.fabric);
  checkGrid(check, scene.cloth, scene.adapt);
  checkPins(check, scene.cloth);
  const double contacts = static_cast<double>(scene.cloth.particles[0]) * scene.cloth.particles[1] *
                          static_cast<double>(scene.obstacles.size() + scene.probes.size());
  check.that(contacts <= kMostContacts, "cloth.particles", rounded(contacts),
             "the product, times the number of obstacles and probes, must be at most 2^26");
  for (std::size_t i = 0; i < scene.obstacles.size(); ++i) {
    Obstacle& obstacle = scene.obstacles[i];
    check.that(!nameOf(shapeNames(), obstacle.shape).empty(), indexed("obstacles", i) + ".shape",
               static_cast<int>(obstacle.shape), "must be one of Shape");
    check.options(indexed("obstacles", i) + ".", ownOptions(obstacle));
    checkPath(check, indexed("obstacles", i) + ".path", obstacle.path);
  }
  checkNames(check, "obstacles", scene.obstacles, false);
  checkNames(check, "probes", scene.probes, true);
  check.that(!scene.probes.empty(), "probes", "{}", "must name at least one probe");
  for (ProbeOptions& probe : scene.probes) checkProbe(check, probeKey(scene, probe), probe, scene.cloth);
}

void validateScene(const Scene& scene, const std::string& origin) {
  checkScene(scene, [&](const std::string&) { return origin; });
}

}  // namespace haptic_cloth
