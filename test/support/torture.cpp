#include "support/torture.h"

#include <gtest/gtest.h>
#include <unistd.h>

#include <cmath>
#include <cstdlib>
#include <filesystem>
#include <fstream>
#include <iomanip>
#include <iostream>
#include <optional>
#include <sstream>

#include "contact/crossings.h"
#include "state/byte_hash.h"
#include "support/scene_text.h"
#include "support/tolerance.h"

namespace haptic_cloth {
namespace {

namespace fs = std::filesystem;

constexpr double kStandardGravity = 9.80665;  // [m/s²], unit of residuals if a scene has no gravity
constexpr double kRoundOff = 1e-10;           // 10³ terms, rounded by 1e-16, over 10³ steps
constexpr double kMostGained = 0.1;           // of the turnover, whatever residuals explain

fs::path outputDirectory() {
  const char* wanted = std::getenv("HAPTIC_CLOTH_TORTURE_OUT");
  return wanted == nullptr ? "torture_failures" : wanted;
}

void writeText(const fs::path& file, const std::string& text) {
  fs::create_directories(file.parent_path());
  std::ofstream stream(file);
  stream << text;
  ASSERT_TRUE(stream.flush()) << file;
}

/// Drives the inputs as `simulate` does (src/tools/run.cpp).
void followPaths(ClothWorld& world, int length) {
  const Scene& scene = world.scene();
  const double h = length * scene.solver.time_step, end = world.time() + h;
  for (int k = 0; k < static_cast<int>(scene.probes.size()); ++k) {
    const ProbeOptions& probe = scene.probes[k];
    if (probe.path.empty()) continue;
    const Vec3 from = pathPosition(probe.path, world.time()), to = pathPosition(probe.path, end);
    world.setDevice(k, {to, (to - from) / h, probe.orientation, h});
    bool closed = false;
    for (const auto& [close, open] : probe.grasp) closed = closed || (close <= end && end < open);
    world.setGrasp(k, closed);
  }
  for (int k = 0; k < static_cast<int>(scene.obstacles.size()); ++k) {
    const Obstacle& obstacle = scene.obstacles[k];
    if (obstacle.path.empty()) continue;
    world.moveObstacle(k, {pathPosition(obstacle.path, end), obstacle.pose.orientation});
  }
}

bool isFinite(const ClothWorld& world, const EnergyReport& energy) {
  bool finite = std::isfinite(energy.total()) && world.supportForce().allFinite();
  const ParticleState& state = world.cloth().state();
  for (const int p : world.cloth().mesh().particle) {
    finite = finite && state.position[p].allFinite() && state.velocity[p].allFinite();
  }
  for (const ProbeReport& probe : world.probes()) {
    finite = finite && probe.force.allFinite() && probe.torque.allFinite() && probe.proxy.allFinite();
  }
  return finite;
}

std::uint64_t hashOf(const ClothWorld& world) {
  ByteHash hash;
  const auto add = [&hash](const Vec3& v) { hash.add(v.data(), sizeof(Vec3)); };
  const ParticleState& state = world.cloth().state();
  for (const int p : world.cloth().mesh().particle) {
    add(state.position[p]);
    add(state.velocity[p]);
  }
  for (const ProbeReport& probe : world.probes()) add(probe.proxy);
  return hash.value();
}

/// One run of a case, step by step, with its energy balance.
class Run {
 public:
  Run(const Torture& wanted, const Scene& scene) : wanted_(wanted), world_(scene) {
    const double size = std::hypot(scene.cloth.size[0], scene.cloth.size[1]);
    const double g = scene.gravity.norm() > 0.0 ? scene.gravity.norm() : kStandardGravity;
    weight_ = cloth().mass() * g;
    result_.energy = weight_ * size;
    ways_.resize(scene.probes.size());
    show();
    began_ = shown_;
    inputs_ = inputs();
  }

  TortureResult run() {
    const double h = world_.scene().solver.time_step;
    const long ticks = std::lround(world_.scene().stop.time / h);
    while (world_.ticks() < ticks && result_.finite) {
      step();
      if (result_.steps % kTell == 0) tell();
    }
    for (const ProbeReport& probe : world_.probes()) {
      if (probe.present) result_.left = std::max(result_.left, (probe.proxy - probe.device).norm());
    }
    result_.hash = hashOf(world_);
    return result_;
  }

  /// Hash after a number of steps, without the balance.
  std::uint64_t hashAfter(long steps) {
    for (long step = 0; step < steps; ++step) {
      drive(step);
      world_.step(length(step));
    }
    return hashOf(world_);
  }

  /// Positions of the devices, as rows of paths.
  const std::vector<std::vector<PathPoint>>& ways() const { return ways_; }
  const std::string& probeRows() const { return rows_; }

 private:
  const Cloth& cloth() const { return world_.cloth(); }

  /// Steps between progress messages of a long run: ten minutes at 1 kHz.
  static constexpr long kTell = 600000;

  void tell() const {
    std::cout << "  " << wanted_.name << ", " << world_.time() << " s: gain " << result_.gain << " J of "
              << result_.energy << " J (allowed " << result_.allowed << " J), stretched " << result_.stretched
              << ", shortened " << result_.shortened << ", speed " << result_.speed << " m/s, " << result_.cut
              << " cut short, " << result_.failed << " failed" << std::endl;
  }

  int length(long step) const { return wanted_.length ? wanted_.length(step) : 1; }

  void drive(long step) {
    followPaths(world_, length(step));
    if (wanted_.before) wanted_.before(world_, step);
  }

  void step() {
    drive(result_.steps);
    const double turned = madeByTurning();
    const StepReport report = world_.step(length(result_.steps));
    const EnergyReport energy = world_.energy();
    ++result_.steps;
    result_.turned += turned;
    allowed_ += turned;
    result_.failed += report.failed ? 1 : 0;
    result_.cut += report.minimizer.why == Termination::Converged ? 0 : 1;
    result_.shortened_steps += report.minimizer.motion_made < 1.0 ? 1 : 0;
    result_.pairs = std::max(result_.pairs, report.self_contacts);
    if (wanted_.limits.crossed.empty())
      result_.crossings = std::max(result_.crossings, findCrossings(cloth().mesh(), cloth().nodes()).pairs);
    result_.finite = isFinite(world_, energy);
    result_.strain = std::max(result_.strain, cloth().internal().maxStrain(cloth().nodes()));
    result_.speed = std::max(result_.speed, cloth().maxSpeed());
    noteMotion();
    result_.penetration = std::max(result_.penetration, report.max_penetration);
    balance(report, energy);
    noteForces(report);
    note();
    if (wanted_.after) wanted_.after(world_, result_.steps - 1);
  }

  /// Bending energy that the next step creates by turning the surface normals to its middle [J]. It is
  /// measured on a copy, because the step makes its mesh decisions with the old normals.
  double madeByTurning() const {
    InternalEnergy internal = cloth().internal();
    const auto bending = [&] {
      return internal.evaluate(internal.gather().firstTriple(), internal.size(), cloth().nodes()).bend;
    };
    const double before = bending(), half = 0.5 * length(result_.steps) * world_.scene().solver.time_step;
    Field middle = cloth().nodes();
    for (int n = 0; n < cloth().mesh().nodes(); ++n)
      middle.set(n, middle[n] + half * cloth().velocities()[n]);
    internal.setNormals(middle);
    return std::max(0.0, bending() - before);
  }

  /// Positions of devices and obstacles; none for a device that is absent.
  std::vector<std::optional<Vec3>> inputs() const {
    std::vector<std::optional<Vec3>> places;
    for (const ProbeReport& probe : world_.probes())
      places.push_back(probe.present ? std::optional(probe.device) : std::nullopt);
    for (std::size_t k = 0; k < world_.scene().obstacles.size(); ++k)
      places.emplace_back(world_.contacts().obstacle(static_cast<int>(k)).position());
    return places;
  }

  /// Records the speed of the inputs in the step (except jumps of devices), the depth of the cloth and its
  /// strain.
  void noteMotion() {
    const double h = world_.objective().timeStep(), g = world_.scene().gravity.norm();
    const std::vector<std::optional<Vec3>> now = inputs();
    for (std::size_t k = 0; k < now.size(); ++k) {
      if (!now[k] || !inputs_[k]) continue;
      const double way = (*now[k] - *inputs_[k]).norm();
      if (!isJump(way, h)) result_.driven = std::max(result_.driven, way / h);
    }
    inputs_ = now;
    for (int n = cloth().mesh().free; n < cloth().mesh().active(); ++n)
      result_.driven = std::max(result_.driven, cloth().velocities()[n].norm());
    for (const Edge& edge : cloth().mesh().edges) {
      const double strain = (cloth().nodes()[edge.b] - cloth().nodes()[edge.a]).norm() / edge.length - 1.0;
      result_.stretched = std::max(result_.stretched, strain);
      result_.shortened = std::max(result_.shortened, -strain);
    }
    for (const int p : cloth().mesh().particle) {
      const double sunk = (cloth().state().position[p] - began_[p]).dot(world_.scene().gravity);
      if (g > 0.0) result_.sunk = std::max(result_.sunk, sunk / g);
    }
  }

  /// Records the force that the couplings cannot explain. The proxy has no mass but that of its
  /// residual, and the report holds the sum of all residuals.
  void noteForces(const StepReport& report) {
    const double residual = std::max(report.minimizer.residual, world_.scene().solver.minimizer.tolerance);
    for (std::size_t k = 0; k < world_.probes().size(); ++k) {
      const ProbeReport& probe = world_.probes()[k];
      if (!probe.present) continue;
      const ProbeOptions& options = world_.scene().probes[k];
      const double slip = (probe.velocity - world_.objective().probeSteps()[k].device_velocity).norm();
      const double pull =
          options.coupling_stiffness * (probe.device - probe.proxy).norm() + options.coupling_damping * slip;
      const double left = residual * weight_ * std::sqrt(countsAs(options) / cloth().mass());
      result_.unexplained = std::max(result_.unexplained, probe.force.norm() - pull - left);
    }
  }

  /// Updates the balance. Energy minus work equals the initial energy minus dissipation, so it may
  /// only fall. The rise and its allowance start again at each low.
  void balance(const StepReport& report, const EnergyReport& energy) {
    const double work = energy.work - work_before_;
    work_before_ = energy.work;
    result_.energy += std::abs(work);
    const double residual = std::max(report.minimizer.residual, world_.scene().solver.minimizer.tolerance);
    allowed_ += residual * weight_ * way() + std::max(0.0, world_.created());
    if (result_.steps > wanted_.set_up)
      result_.created = std::max(result_.created, world_.created() / result_.energy);
    if (energy.dissipated >= most_dissipated_ || result_.steps <= wanted_.set_up) {
      most_dissipated_ = energy.dissipated;
      allowed_ = 0.0;
    } else if (most_dissipated_ - energy.dissipated > result_.gain) {
      result_.gain = most_dissipated_ - energy.dissipated;
      result_.allowed = allowed_;
    }
  }

  /// Mass with which the residual of a proxy counts, h (h k + b) [kg].
  double countsAs(const ProbeOptions& probe) const {
    const double h = world_.objective().timeStep();
    return h * (h * probe.coupling_stiffness + probe.coupling_damping);
  }

  /// Displacement of particles and proxies in the step, rms by mass; of a proxy with that of its turn [m].
  double way() {
    double sum = 0.0;
    const double h = world_.objective().timeStep();
    for (std::size_t k = 0; k < world_.probes().size(); ++k) {
      if (!world_.probes()[k].present) continue;
      const ProbeOptions& options = world_.scene().probes[k];
      const double turn = world_.objective().turn(static_cast<int>(k)).squaredNorm();
      sum += countsAs(options) *
             ((h * world_.probes()[k].velocity).squaredNorm() + turnRadiusSquared(options) * turn);
    }
    shown_.swap(shown_before_);
    show();
    for (int n = 0; n < cloth().mesh().active(); ++n) {
      const int p = cloth().mesh().particle[n];
      sum += cloth().mesh().mass[n] * (shown_[p] - shown_before_[p]).squaredNorm();
    }
    return std::sqrt(sum / cloth().mass());
  }

  /// Records the positions of all finest particles, interpolated in coarse cells.
  void show() {
    shown_ = cloth().state().position;
    for (const Patch& patch : cloth().mesh().patches) {
      if (patch.cell.level > 0) interpolateCell(cloth().grid(), patch.cell, shown_);
    }
  }

  void note() {
    // Enough to reach a failure; a soak test would fill the disk.
    constexpr long kMostRows = 200000;
    std::ostringstream rows;
    rows.precision(17);
    for (std::size_t k = 0; k < world_.probes().size(); ++k) {
      const ProbeReport& probe = world_.probes()[k];
      if (!probe.present) continue;
      result_.force = std::max(result_.force, probe.force.norm());
      if (result_.steps > kMostRows) continue;
      if (ways_[k].empty()) ways_[k].push_back({0.0, probe.device});
      ways_[k].push_back({world_.time(), probe.device});
      rows << world_.time() << ',' << k;
      for (const Vec3& v : {probe.device, probe.proxy, probe.force}) {
        rows << ',' << v.x() << ',' << v.y() << ',' << v.z();
      }
      rows << '\n';
    }
    rows_ += rows.str();
  }

  const Torture& wanted_;
  ClothWorld world_;
  TortureResult result_;
  double weight_ = 0.0, work_before_ = 0.0, most_dissipated_ = 0.0, allowed_ = 0.0;
  std::vector<Vec3> shown_, shown_before_, began_;
  std::vector<std::optional<Vec3>> inputs_;  ///< positions at the end of the last step
  std::vector<std::vector<PathPoint>> ways_;
  std::string rows_;
};

void judge(const Torture& wanted, const TortureResult& result) {
  const TortureLimits& limits = wanted.limits;
  const auto keep = [&](const std::string& what, double measured, double limit, const std::string& unit) {
    recordMargin(wanted.name, what, measured, limit, unit);
    EXPECT_LE(measured, tolerance(limit)) << wanted.name << ": " << what;
  };
  EXPECT_TRUE(result.finite) << wanted.name << ", step " << result.steps;
  keep("energy gained / turned over", result.gain / result.energy,
       std::min(kMostGained, kRoundOff + result.allowed / result.energy), "-");
  keep("made by a mesh change / turned over", result.created, limits.created, "-");
  keep("made by turning normals / turned over", result.turned / result.energy, limits.turned, "-");
  keep("largest strain", limits.pushed ? result.stretched : result.strain,
       limits.strain > 0.0 ? limits.strain : strainLimit(result, wanted.scene, false), "-");
  if (limits.pushed) {
    keep("pushed together", result.shortened, std::min(1.0, strainLimit(result, wanted.scene, true)), "-");
  }
  if (limits.any_speed.empty()) {
    keep("fastest particle", result.speed, speedLimit(result, wanted.scene) + limits.thrown, "m/s");
  } else {
    recordMargin(wanted.name, "fastest particle", result.speed, 0.0, "m/s", limits.any_speed);
  }
  if (limits.crossed.empty()) {
    keep("crossings", result.crossings, 0.0, "");
  } else {
    recordMargin(wanted.name, "crossings", result.crossings, 0.0, "", limits.crossed);
  }
  EXPECT_LE(result.unexplained, tolerance(kRoundOff * (1.0 + result.force))) << wanted.name << ": force [N]";
  keep("failed steps", static_cast<double>(result.failed), limits.failed, "");
  std::cout << "  " << wanted.name << ": " << result.steps << " steps, " << result.cut << " cut short, gain "
            << result.gain << " J of " << result.energy << " J (allowed " << result.allowed << " J), force "
            << result.force << " N, penetration " << result.penetration << " m, " << result.pairs
            << " pairs press, " << result.shortened_steps << " steps made in part\n";
}

}  // namespace

std::string writeFabric(const LinearFabric& linear) {
  std::ostringstream text;
  text.precision(17);
  text << "name: linear\nsource: \"made up for a test\"\nareal_density: " << linear.areal_density
       << "\nthickness: " << linear.thickness << "\ntensile: {stiffness: " << linear.stiffness
       << "}\nbending: {rigidity: " << linear.rigidity << "}\nshear: {modulus: " << linear.shear_modulus
       << "}\ncompression_ratio: " << linear.compression << '\n';
  if (const auto& measured = linear.measured) {
    text << "compression: {T0: " << 1e3 * measured->thickness << ", Tm: " << 1e3 * measured->pressed_thickness
         << ", LC: " << measured->linearity << "}\n";
  }
  std::ostringstream name;
  name << testing::TempDir() << "haptic_cloth_fabric_" << std::hash<std::string>()(text.str()) << ".yaml";
  // Another process may write the same file.
  const std::string partial = name.str() + std::to_string(getpid());
  writeText(partial, text.str());
  fs::rename(partial, name.str());
  return name.str();
}

std::string saveTorture(const Torture& wanted, const std::string& directory) {
  const fs::path scene = fs::path(directory) / "scene.yaml", fabric = fs::path(directory) / "fabric.yaml";
  writeText(scene, sceneText(wanted.scene, "fabric.yaml"));
  fs::copy_file(wanted.fabric_file, fabric, fs::copy_options::overwrite_existing);
  return scene.string();
}

TortureResult torture(const Torture& wanted) {
  const bool had_failed = testing::Test::HasFailure();
  const fs::path directory = outputDirectory() / wanted.name;
  // The run uses the saved scene, read back.
  Scene scene = loadScene(saveTorture(wanted, directory.string()));
  Run run(wanted, scene);
  TortureResult result = run.run();
  scene.solver.threads = 2;
  EXPECT_EQ(Run(wanted, scene).hashAfter(result.steps), result.hash)
      << wanted.name << ": bits differ with two threads";
  judge(wanted, result);
  if (had_failed || !testing::Test::HasFailure()) {
    fs::remove_all(directory);
    return result;
  }
  Torture saved = wanted;
  for (std::size_t k = 0; k < saved.scene.probes.size(); ++k) {
    if (saved.scene.probes[k].path.empty()) saved.scene.probes[k].path = run.ways()[k];
  }
  saveTorture(saved, directory.string());
  writeText(directory / "probe.csv",
            "time,probe,device_x,device_y,device_z,proxy_x,proxy_y,proxy_z,force_x,force_y,force_z\n" +
                run.probeRows());
  std::cout << "  replay: simulate " << (directory / "scene.yaml").string()
            << (wanted.before || wanted.length ? "   (the test did more than a scene can say)" : "") << '\n';
  return result;
}

void recordMargin(const std::string& test_case, const std::string& criterion, double measured, double limit,
                  const std::string& unit, const std::string& unchecked) {
  EXPECT_TRUE(std::isfinite(limit)) << test_case << ": " << criterion << ": a limit that says nothing";
  if (std::getenv("HAPTIC_CLOTH_TORTURE_OUT") == nullptr) return;
  fs::create_directories(outputDirectory());
  std::ofstream file(outputDirectory() / "margins.csv", std::ios::app);
  file.precision(6);
  file << '"' << test_case << "\",\"" << criterion << "\"," << measured << ',' << limit << ",\"" << unit
       << "\",\"" << unchecked << "\"\n";
}

double tortureLength(const char* variable, double short_form) {
  const char* length = std::getenv(variable);
  return length == nullptr ? short_form : std::strtod(length, nullptr);
}

}  // namespace haptic_cloth
