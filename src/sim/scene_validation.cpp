#include "sim/scene_validation.h"

#include <algorithm>
#include <cctype>
#include <cmath>
#include <locale>
#include <sstream>

#include "haptic_cloth/error.h"
#include "sim/scene_names.h"
#include "state/number_text.h"

namespace haptic_cloth {
namespace {

constexpr int kMostLevels = 8;
constexpr int kMostThreads = 1024;
constexpr double kMostParticles = 1 << 24;  ///< so that every index and offset fits an int
/// Largest position [m] and gravity [m/s²]; beyond it, millimetres are lost to rounding.
constexpr double kMost = 1e6;
/// Limits of other values: products and quotients stay finite.
constexpr double kSmallest = 1e-12, kLargest = 1e12;
/// Largest number of particles times solids: memory is reserved for each pair.
constexpr double kMostContacts = 1 << 26;
constexpr std::size_t kMostProbes = 64, kMostObstacles = 1024, kMostPins = 4096;
constexpr double kFinestProbe = 0.02;    ///< smallest radius of a probe / finest spacing [-]
constexpr double kUnitTolerance = 1e-6;  ///< error allowed in a quaternion's norm [-]

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

  void positive(const std::string& key, double value) const {
    that(std::isfinite(value) && value > 0.0, key, value, "must be > 0");
    that(value >= kSmallest && value <= kLargest, key, value, "must be within 1e-12 to 1e12");
  }
  void length(const std::string& key, double value) const {
    positive(key, value);
    that(value <= kMost, key, value, "must be at most 1e6");
  }
  void count(const std::string& key, std::size_t value, std::size_t most) const {
    that(value <= most, key, std::to_string(value) + " entries", "must have at most " + std::to_string(most));
  }
  void notNegative(const std::string& key, double value) const {
    that(std::isfinite(value) && value >= 0.0, key, value, "must be >= 0");
    that(value <= kLargest, key, value, "must be at most 1e12");
  }
  void atLeast(const std::string& key, int value, int least) const {
    that(value >= least, key, value, "must be >= " + std::to_string(least));
  }
  void within(const std::string& key, int value, int least, int most) const {
    that(value >= least && value <= most, key, value,
         "must be in " + std::to_string(least) + " to " + std::to_string(most));
  }
  void finite(const std::string& key, const Vec3& value) const {
    that(value.allFinite(), key, value.transpose(), "must be finite");
    that(value.cwiseAbs().maxCoeff() <= kMost, key, value.transpose(), "must be within -1e6 to 1e6");
  }
  void pose(const std::string& prefix, const Pose& pose) const {
    finite(prefix + ".position", pose.position);
    const double norm = pose.orientation.norm();
    that(std::abs(norm - 1.0) <= kUnitTolerance, prefix + ".orientation",
         pose.orientation.coeffs().transpose(), "must be a unit quaternion x y z w");
  }

 private:
  const Locate& locate_;
};

std::string indexed(const std::string& key, std::size_t index) {
  return key + '[' + std::to_string(index) + ']';
}

void checkGrid(const Check& check, const ClothOptions& cloth, const AdaptOptions& adapt) {
  check.within("adapt.levels", adapt.levels, 0, kMostLevels);
  const int coarsest = 1 << adapt.levels;
  for (std::size_t d = 0; d < 2; ++d) {
    const std::string key = indexed("cloth.particles", d);
    check.atLeast(key, cloth.particles[d], 2);
    check.that((cloth.particles[d] - 1) % coarsest == 0, key, cloth.particles[d],
               "particles - 1 must be divisible by 2^adapt.levels = " + std::to_string(coarsest));
    check.length(indexed("cloth.size", d), cloth.size[d]);
  }
  const double count = static_cast<double>(cloth.particles[0]) * cloth.particles[1];
  check.that(count <= kMostParticles, "cloth.particles", rounded(count), "the product must be at most 2^24");
}

void checkPins(const Check& check, const ClothOptions& cloth) {
  check.count("cloth.pins", cloth.pins.size(), kMostPins);
  for (std::size_t p = 0; p < cloth.pins.size(); ++p) {
    const ParticleRange& pin = cloth.pins[p];
    const std::string key = indexed("cloth.pins", p);
    const auto range = [&](const std::string& name, int from, int to, int count) {
      check.that(
          from >= 0 && from <= to && to < count, key,
          "[" + std::to_string(from) + ", " + std::to_string(to) + "]",
          name + " must be a range [first, last] with 0 <= first <= last <= " + std::to_string(count - 1));
    };
    range("particles[0]", pin.i0, pin.i1, cloth.particles[0]);
    range("particles[1]", pin.j0, pin.j1, cloth.particles[1]);
  }
}

void checkPath(const Check& check, const std::string& prefix, const std::vector<PathPoint>& path) {
  for (std::size_t i = 0; i < path.size(); ++i) {
    const std::string key = indexed(prefix, i);
    const double time = path[i].time;
    check.finite(key, path[i].position);
    check.that(std::isfinite(time), key + "[0]", time, "must be finite");
    check.that(std::abs(time) <= kLargest, key + "[0]", time, "must be within -1e12 to 1e12");
    check.that(i == 0 || time > path[i - 1].time, key + "[0]", time,
               "times must increase strictly from row to row");
  }
}

void checkObstacle(const Check& check, const std::string& key, const Obstacle& obstacle) {
  switch (obstacle.shape) {
    case Shape::Box:
      for (int d = 0; d < 3; ++d) {
        check.length(indexed(key + ".size", static_cast<std::size_t>(d)), obstacle.size[d]);
      }
      break;
    case Shape::Cylinder:
    case Shape::Capsule:
      check.length(key + ".length", obstacle.length);
      check.length(key + ".radius", obstacle.radius);
      break;
    case Shape::Sphere:
      check.length(key + ".radius", obstacle.radius);
      break;
    case Shape::Plane:
      break;
  }
  check.pose(key, obstacle.pose);
  check.notNegative(key + ".friction", obstacle.friction);
  checkPath(check, key + ".path", obstacle.path);
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
void checkProbe(const Check& check, const std::string& prefix, const ProbeOptions& probe,
                const ClothOptions& cloth) {
  check.length(prefix + ".radius", probe.radius);
  check.that(probe.radius >= smallestProbeRadius(cloth), prefix + ".radius", probe.radius,
             "must be at least a fiftieth of the finest spacing");
  check.notNegative(prefix + ".length", probe.length);
  check.that(probe.length <= kMost, prefix + ".length", probe.length, "must be at most 1e6");
  check.notNegative(prefix + ".friction", probe.friction);
  check.positive(prefix + ".coupling_stiffness", probe.coupling_stiffness);
  check.notNegative(prefix + ".coupling_damping", probe.coupling_damping);
  check.pose(prefix, {Vec3::Zero(), probe.orientation});
  checkPath(check, prefix + ".path", probe.path);
  for (std::size_t i = 0; i < probe.grasp.size(); ++i) {
    const auto [from, to] = probe.grasp[i];
    check.that(std::isfinite(from) && from < to, indexed(prefix + ".grasp", i), from,
               "must be [from, to] with from < to");
  }
}

void checkOptions(const Check& check, const Scene& scene) {
  const SolverOptions& solver = scene.solver;
  check.positive("solver.time_step", solver.time_step);
  check.notNegative("solver.tolerance", solver.minimizer.tolerance);
  check.notNegative("solver.sleep_speed", solver.sleep_speed);
  check.atLeast("solver.max_iterations", solver.minimizer.max_iterations, 1);
  check.notNegative("solver.time_budget", solver.minimizer.time_budget);
  check.within("solver.threads", solver.threads, 0, kMostThreads);

  const AdaptOptions& adapt = scene.adapt;
  check.atLeast("adapt.interval", adapt.interval, 1);
  check.positive("adapt.refine_above", adapt.refine_above);
  check.notNegative("adapt.coarsen_below", adapt.coarsen_below);
  check.positive("adapt.refine_above_strain", adapt.refine_above_strain);
  check.notNegative("adapt.coarsen_below_strain", adapt.coarsen_below_strain);
  const auto below = [&check](const char* key, double value, const char* bound, double most) {
    check.that(value < most, key, value, std::string("must be below ") + bound + " = " + shortestText(most));
  };
  below("adapt.coarsen_below", adapt.coarsen_below, "adapt.refine_above", adapt.refine_above);
  below("adapt.coarsen_below_strain", adapt.coarsen_below_strain, "adapt.refine_above_strain",
        adapt.refine_above_strain);
  check.atLeast("adapt.minimum_age", adapt.minimum_age, 0);

  check.positive("stop.time", scene.stop.time);
  check.notNegative("stop.rest_speed", scene.stop.rest_speed);
}

}  // namespace

double smallestProbeRadius(const ClothOptions& cloth) {
  return kFinestProbe *
         std::min(cloth.size[0] / (cloth.particles[0] - 1), cloth.size[1] / (cloth.particles[1] - 1));
}

void checkScene(const Scene& scene, const Locate& locate) {
  const Check check(locate);
  checkGrid(check, scene.cloth, scene.adapt);
  check.pose("cloth", scene.cloth.pose);
  check.positive("cloth.fabric.areal_density", scene.cloth.fabric.areal_density);
  check.positive("cloth.fabric.thickness", scene.cloth.fabric.thickness);
  checkPins(check, scene.cloth);
  check.finite("gravity", scene.gravity);
  check.count("obstacles", scene.obstacles.size(), kMostObstacles);
  check.count("probes", scene.probes.size(), kMostProbes);
  const double contacts = static_cast<double>(scene.cloth.particles[0]) * scene.cloth.particles[1] *
                          static_cast<double>(scene.obstacles.size() + scene.probes.size());
  check.that(contacts <= kMostContacts, "cloth.particles", rounded(contacts),
             "the product, times the number of obstacles and probes, must be at most 2^26");
  check.notNegative("air_damping", scene.air_damping);
  for (std::size_t i = 0; i < scene.obstacles.size(); ++i) {
    checkObstacle(check, indexed("obstacles", i), scene.obstacles[i]);
  }
  checkNames(check, "obstacles", scene.obstacles, false);
  checkNames(check, "probes", scene.probes, true);
  check.that(!scene.probes.empty(), "probes", "{}", "must name at least one probe");
  for (const ProbeOptions& probe : scene.probes) {
    const bool only = scene.probes.size() == 1 && probe.name == ProbeOptions().name;
    checkProbe(check, only ? "probe" : "probes." + probe.name, probe, scene.cloth);
  }
  checkOptions(check, scene);
}

void validateScene(const Scene& scene, const std::string& origin) {
  checkScene(scene, [&](const std::string&) { return origin; });
}

}  // namespace haptic_cloth
