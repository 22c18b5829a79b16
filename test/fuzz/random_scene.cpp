#include "fuzz/random_scene.h"

#include <Eigen/Geometry>
#include <algorithm>
#include <cmath>
#include <filesystem>
#include <iomanip>
#include <locale>
#include <sstream>
#include <vector>

#include "fuzz/mutation.h"

namespace haptic_cloth {
namespace {

namespace fs = std::filesystem;

std::vector<std::string> fabricNames() {
  std::vector<std::string> names;
  for (const auto& entry : fs::directory_iterator(fs::path(HAPTIC_CLOTH_SOURCE_DIR) / "config/fabrics")) {
    names.push_back(entry.path().stem().string());
  }
  std::sort(names.begin(), names.end());
  return names;
}

/// Writes one scene.
class Writer {
 public:
  Writer(std::uint64_t seed, const RandomSceneLimits& limits) : dice_(seed), limits_(limits) {
    text_.imbue(std::locale::classic());
    text_ << std::setprecision(17) << "# random scene " << seed << "\n";
  }

  std::string write() {
    joint_ = dice_.chance(0.12);
    cloth();
    world();
    obstacles();
    probes();
    options();
    return text_.str();
  }

 private:
  /// Writes the grid. Most grids are small; some are large enough to be run on several threads.
  void grid() {
    levels_ = dice_.within(0, 4);
    const int coarsest = 1 << levels_;
    const double most = joint_ ? 300.0 : limits_.particles;
    for (int& count : particles_) count = coarsest + 1;
    const double wanted = dice_.logUniform(4.0, most);
    for (int tries = 0; tries < 200; ++tries) {
      int& count = particles_[dice_.below(2)];
      const double other = static_cast<double>(particles_[0]) * particles_[1] / count;
      if ((count + coarsest) * other <= wanted) count += coarsest;
    }
    spacing_ = dice_.logUniform(1e-3, 0.02);
    for (int d = 0; d < 2; ++d) size_[d] = spacing_ * (particles_[d] - 1) * dice_.logUniform(1.0, 3.0);
  }

  void cloth() {
    grid();
    text_ << "cloth:\n  particles: [" << particles_[0] << ", " << particles_[1] << "]\n  size: [" << size_[0]
          << ", " << size_[1] << "]\n";
    centre_ = Eigen::Vector3d(0.0, 0.0, dice_.uniform(0.0, 0.3));
    text_ << "  position: " << list(centre_) << "\n";
    if (dice_.chance(0.5)) text_ << "  orientation: " << orientation() << "\n";
    text_ << "  fabric: " << dice_.choice(fabricNames()) << "\n";
    const int pins = std::max(0, dice_.within(-2, 3));
    if (pins == 0) return;
    text_ << "  pins:\n";
    for (int k = 0; k < pins; ++k) text_ << "    - " << pin() << "\n";
  }

  std::string pin() {
    const std::vector<std::string> names{"corner_00", "corner_10", "corner_01", "corner_11",
                                         "edge_x0",   "edge_x1",   "edge_y0",   "edge_y1"};
    if (dice_.chance(0.6)) return dice_.choice(names);
    std::ostringstream text;
    text << "{particles: [";
    for (int d = 0; d < 2; ++d) {
      const int from = dice_.within(0, particles_[d] - 1);
      text << "[" << from << ", " << dice_.within(from, std::min(from + 3, particles_[d] - 1)) << "]"
           << (d == 0 ? ", " : "]}");
    }
    return text.str();
  }

  void world() {
    if (dice_.chance(0.15))
      text_ << "gravity: [0, 0, 0]\n";
    else if (dice_.chance(0.2))
      text_ << "gravity: " << list(20.0 * direction()) << "\n";
    text_ << "air_damping: " << dice_.choice(std::vector<double>{0.0, 0.5, 0.5, 5.0}) << "\n";
  }

  /// A place near the cloth, mostly below it. A solid there often cuts through the cloth.
  Eigen::Vector3d near(double reach) {
    // Braces, because their arguments are evaluated in order by every compiler.
    return centre_ + Eigen::Vector3d{dice_.uniform(-0.6, 0.6) * size_[0], dice_.uniform(-0.6, 0.6) * size_[1],
                                     dice_.uniform(-1.0, 0.3) * reach};
  }

  void obstacles() {
    const int count = std::max(0, dice_.within(-1, 3));
    if (count > 0) text_ << "obstacles:\n";
    const double extent = std::max(size_[0], size_[1]);
    for (int k = 0; k < count; ++k) {
      const double size = dice_.logUniform(0.05, 1.5) * extent;
      const std::string radius = number("radius", 0.5 * size);
      const std::string length = number("length", size * dice_.uniform(0.2, 2.0));
      const std::vector<std::string> shapes{
          "shape: plane", "shape: sphere, " + radius, "shape: cylinder, " + radius + ", " + length,
          "shape: capsule, " + radius + ", " + length,
          "shape: box, size: " +
              list(size * Eigen::Vector3d{1.0, dice_.uniform(0.2, 1.0), dice_.uniform(0.1, 1.0)})};
      const std::size_t shape = dice_.below(shapes.size());
      const bool plane = shape == 0;
      const Eigen::Vector3d place =
          plane ? Eigen::Vector3d(centre_ - 0.3 * extent * Eigen::Vector3d::UnitZ()) : near(size);
      text_ << "  - {" << shapes[shape] << ", position: " << list(place);
      if (!plane && dice_.chance(0.5)) text_ << ", orientation: " << orientation();
      text_ << ", friction: " << dice_.choice(std::vector<double>{0.0, 0.2, 0.3, 1.0});
      if (dice_.chance(0.2)) text_ << ", path: " << path(place, extent);
      text_ << "}\n";
    }
  }

  /// A path with legs of 5 to 30 ms, sometimes faster than any hand.
  std::string path(const Eigen::Vector3d& start, double extent) {
    std::ostringstream text;
    text.imbue(std::locale::classic());
    text << std::setprecision(17) << "[";
    double time = dice_.chance(0.3) ? 0.01 : 0.0;
    Eigen::Vector3d place = start;
    for (int rows = dice_.within(1, 5); rows > 0; --rows) {
      text << "[" << time << ", " << place.x() << ", " << place.y() << ", " << place.z() << "]"
           << (rows > 1 ? ", " : "]");
      time += dice_.uniform(0.005, 0.03);
      place += std::min(extent, 0.05) * dice_.uniform(0.0, 1.0) * direction();
    }
    return text.str();
  }

  void probes() {
    const int count = dice_.within(0, 3);
    if (count > 0) text_ << "probes:\n";
    for (int k = 0; k < count; ++k) {
      const double radius = spacing_ * dice_.logUniform(0.2, 4.0);
      text_ << "  p" << k << ": {" << number("radius", radius);
      if (dice_.chance(0.3)) {
        text_ << ", shape: capsule, " << number("length", radius * dice_.uniform(0.0, 6.0))
              << ", orientation: " << orientation();
      }
      text_ << ", friction: " << dice_.uniform(0.0, 1.0) << ", "
            << number("coupling_stiffness", dice_.logUniform(50.0, 3000.0)) << ", "
            << number("coupling_damping", dice_.choice(std::vector<double>{0.0, 1.0, 5.0}));
      const bool moves = dice_.chance(0.9);
      if (moves) text_ << ", path: " << path(near(0.05), 0.1);
      if (dice_.chance(0.3) && moves) text_ << ", grasp: [[0.005, 0.02], [0.03, 1]]";
      text_ << "}\n";
    }
  }

  void options() {
    const double step = dice_.logUniform(1e-4, 0.02);
    const double count = static_cast<double>(particles_[0]) * particles_[1];
    const int steps = std::clamp(static_cast<int>((joint_ ? 0.1 : 1.0) * limits_.work / count), 3, 60);
    const std::vector<int> iterations{1, 2, 10, 50, 200, 200};
    const std::vector<std::string> preconditioners{"none", "jacobi", "multilevel", "multilevel",
                                                   "multilevel"};
    text_ << "solver: {" << number("time_step", step)
          << ", integrator: " << (dice_.chance(0.5) ? "bdf2" : "euler")
          << ", cost: " << (joint_ ? "joint" : "condensed")
          << ", preconditioner: " << dice_.choice(preconditioners) << ", "
          << number("tolerance", dice_.logUniform(0.01, 0.5))
          << ", max_iterations: " << dice_.choice(iterations)
          << ", sleep_speed: " << dice_.choice(std::vector<double>{0.0, 3e-4, 3e-4, 0.1}) << "}\n";
    const double turn = dice_.logUniform(0.02, 1.0), strain = dice_.logUniform(5e-4, 0.05);
    const std::vector<std::string> strategies{"finest", "coarsest", "refine", "coarsen", "amrc", "amrc"};
    const std::string strategy = dice_.choice(strategies);
    text_ << "adapt: {strategy: " << strategy << ", levels: " << levels_
          << ", interval: " << dice_.within(1, 5) << ", " << number("refine_above", turn) << ", "
          << number("coarsen_below", turn * dice_.uniform(0.0, 0.99)) << ", "
          << number("refine_above_strain", strain) << ", "
          << number("coarsen_below_strain", strain * dice_.uniform(0.0, 0.99))
          << ", minimum_age: " << dice_.choice(std::vector<int>{0, 1, 3, 30});
    if (strategy == "amrc" && dice_.chance(0.3)) text_ << ", start: coarsest";
    if (dice_.chance(0.3)) {
      text_ << ", " << number("far_angle_factor", dice_.logUniform(1.0, 10.0)) << ", "
            << number("far_strain_factor", dice_.logUniform(1.0, 100.0)) << ", "
            << number("near_reach", dice_.uniform(0.0, 10.0)) << ", "
            << number("near_load", dice_.logUniform(1e-3, 1.0));
    }
    text_ << "}\n";
    text_ << "stop: {" << number("time", step * steps) << "}\n";
  }

  static std::string number(const std::string& key, double value) {
    std::ostringstream text;
    text.imbue(std::locale::classic());
    text << key << ": " << std::setprecision(17) << value;
    return text.str();
  }

  static std::string list(const Eigen::Vector3d& v) {
    std::ostringstream text;
    text.imbue(std::locale::classic());
    text << std::setprecision(17) << "[" << v.x() << ", " << v.y() << ", " << v.z() << "]";
    return text.str();
  }

  Eigen::Vector3d direction() {
    const double z = dice_.uniform(-1.0, 1.0), turn = dice_.uniform(0.0, 2.0 * EIGEN_PI),
                 r = std::sqrt(1.0 - z * z);
    return {r * std::cos(turn), r * std::sin(turn), z};
  }

  std::string orientation() {
    const Eigen::AngleAxisd turn{dice_.uniform(0.0, EIGEN_PI), direction()};
    const Eigen::Vector4d q = Eigen::Quaterniond(turn).normalized().coeffs();
    std::ostringstream text;
    text.imbue(std::locale::classic());
    text << std::setprecision(17) << "[" << q[0] << ", " << q[1] << ", " << q[2] << ", " << q[3] << "]";
    return text.str();
  }

  Dice dice_;
  RandomSceneLimits limits_;
  std::ostringstream text_;
  bool joint_ = false;
  int levels_ = 0;
  int particles_[2] = {2, 2};
  double spacing_ = 0.0, size_[2] = {0.0, 0.0};  ///< [m]
  Eigen::Vector3d centre_ = Eigen::Vector3d::Zero();
};

}  // namespace

std::string randomScene(std::uint64_t seed, const RandomSceneLimits& limits) {
  return Writer(seed, limits).write();
}

}  // namespace haptic_cloth
