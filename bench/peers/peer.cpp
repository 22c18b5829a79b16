#include "peer.h"

#include <algorithm>
#include <array>
#include <chrono>
#include <cmath>
#include <filesystem>
#include <fstream>
#include <iomanip>
#include <iostream>
#include <limits>
#include <sstream>

#include "contact/crossings.h"
#include "contact/solid.h"
#include "energy/internal_energy.h"
#include "haptic_cloth/error.h"
#include "haptic_cloth/machine.h"
#include "mesh/active_mesh.h"
#include "tools/command_line.h"

namespace haptic_cloth {
namespace peers {
namespace {

using nlohmann::json;

struct ProbeRow {
  double time;
  Vec3 device, proxy, force;
};

constexpr int kInstants = 10;

/// State at one of kInstants times, evenly spaced from the start to stop.time.
struct Instant {
  double time;         ///< [s]
  int crossings;       ///< pairs of an edge and a triangle that cut each other
  double stretch;      ///< largest strain along a thread
  double compression;  ///< largest negative strain along a thread, as a positive number
  double energy;       ///< kinetic, of gravity, and of the fabric [J]
  double speed;        ///< of the fastest particle over the last frame [m/s]
  Vec3 extent;         ///< largest |coordinate| of each axis [m]
};

/// One run; the wall time is that of the peer's steps alone.
struct Run {
  double wall_time = 0.0, time = 0.0;
  int steps = 0;
  bool at_rest = false, stopped = false;  ///< stopped: by the limit of wall time
  std::vector<Instant> instants;
  double start_energy = 0.0;
  double max_speed = 0.0, max_penetration = 0.0;
  std::vector<Vec3> positions;
  std::vector<ProbeRow> probe;
};

Grid finestGrid(const Scene& scene) {
  const auto& [columns, rows] = scene.cloth.particles;
  return {columns, rows, 0, scene.cloth.size[0] / (columns - 1), scene.cloth.size[1] / (rows - 1)};
}

double penetration(const std::vector<Solid>& solids, const std::vector<Vec3>& positions) {
  double deepest = 0.0;
  for (const Solid& solid : solids) {
    for (const Vec3& x : positions) deepest = std::max(deepest, -solid.distance(x).value);
  }
  return deepest;
}

/// Speed of the fastest particle [m/s]; not a number if a position is not finite.
double fastest(const std::vector<Vec3>& before, const std::vector<Vec3>& after, double duration) {
  double largest = 0.0;
  for (std::size_t p = 0; p < after.size(); ++p) {
    const double moved = (after[p] - before[p]).norm();
    if (!std::isfinite(moved)) return std::numeric_limits<double>::quiet_NaN();
    largest = std::max(largest, moved);
  }
  return largest / duration;
}

/// The finest mesh with all particles in their places.
struct FinestMesh {
  FinestMesh(const Scene& scene, const std::vector<Vec3>& positions)
      : leaves(finestGrid(scene), scene.cloth.pins, 0), mesh(leaves, scene.cloth.fabric.areal_density) {
    x.resize(mesh.nodes());
    for (int n = 0; n < mesh.nodes(); ++n) x.set(n, positions[mesh.particle[n]]);
  }

  LeafMesh leaves;
  ActiveMesh mesh;
  Field x;
};

/// Energies of a shape by the package's own laws, and strains along its threads.
json measureShape(const Scene& scene, const FinestMesh& finest) {
  const ActiveMesh& mesh = finest.mesh;
  const Field& x = finest.x;
  InternalEnergy internal(scene.cloth.fabric, mesh);
  double gravity = 0.0;
  for (int n = 0; n < mesh.nodes(); ++n) gravity -= mesh.mass[n] * scene.gravity.dot(x[n]);
  double sum = 0.0, weights = 0.0, stretch = 0.0, compression = 0.0;
  for (const Edge& edge : mesh.edges) {
    const double strain = (x[edge.b] - x[edge.a]).norm() / edge.length - 1.0;
    sum += edge.width * edge.length * std::abs(strain);
    weights += edge.width * edge.length;
    stretch = std::max(stretch, strain);
    compression = std::max(compression, -strain);
  }
  internal.setNormals(x);
  const InternalEnergy::Energy e = internal.evaluate(0, internal.size(), x);
  return {{"energy",
           {{"gravity", gravity},
            {"stretch", e.stretch},
            {"bend", e.bend},
            {"shear", e.shear},
            {"contact", 0.0}}},
          {"max_strain", std::max(stretch, compression)},
          {"stretch", stretch},
          {"compression", compression},
          {"mean_strain", weights > 0.0 ? sum / weights : 0.0}};
}

double kineticEnergy(const Scene& scene, const std::vector<Vec3>& before, const std::vector<Vec3>& after,
                     double duration) {
  const std::vector<double> masses = particleMasses(scene);
  double sum = 0.0;
  for (std::size_t p = 0; p < masses.size(); ++p) {
    sum += 0.5 * masses[p] * ((after[p] - before[p]) / duration).squaredNorm();
  }
  return sum;
}

/// Measures the present state. The kinetic energy is that of the mean velocities over the last frame.
Instant measure(const Peer& peer, const Scene& scene, double time, const std::vector<Vec3>& before,
                const std::vector<Vec3>& positions) {
  const FinestMesh finest(scene, positions);
  const json shape = measureShape(scene, finest);
  Instant now{time, 0, shape["stretch"], shape["compression"], 0.0, 0.0, Vec3::Zero()};
  if (const auto own = peer.ownMeasure()) {
    now.crossings = own->crossings;
    now.energy = own->energy;
  } else {
    now.crossings = findCrossings(finest.mesh, finest.x).pairs;
    now.energy = kineticEnergy(scene, before, positions, peer.frame());
    for (const json& part : shape["energy"]) now.energy += part.get<double>();
  }
  now.speed = fastest(before, positions, peer.frame());
  for (const Vec3& x : positions) now.extent = now.extent.cwiseMax(x.cwiseAbs());
  return now;
}

/// Runs by the rules of `simulate`: until stop.time, or until all particles have been slow for 0.1 s; or
/// until the steps have taken `limit` of wall time [s], if it is not 0.
Run runToEnd(Peer& peer, const Scene& scene, double limit) {
  constexpr double kRestDuration = 0.1;  // [s]
  std::vector<Solid> solids(scene.obstacles.begin(), scene.obstacles.end());
  const bool has_probe = !scene.probes[0].path.empty();
  const double frame = peer.frame();
  Run run;
  std::vector<Vec3> before;
  peer.positions(run.positions);
  run.start_energy = measure(peer, scene, 0.0, run.positions, run.positions).energy;
  double slow_since = 0.0;
  while (run.time < scene.stop.time - 0.5 * frame) {
    if (limit > 0.0 && run.wall_time > limit) {
      run.stopped = true;
      break;
    }
    const Vec3 from = pathPosition(scene.probes[0].path, run.time);
    const Vec3 device = pathPosition(scene.probes[0].path, run.time + frame);
    before.swap(run.positions);
    const auto start = std::chrono::steady_clock::now();
    peer.step(has_probe ? &device : nullptr, (device - from) / frame);
    run.wall_time += std::chrono::duration<double>(std::chrono::steady_clock::now() - start).count();
    run.time = ++run.steps * frame;
    peer.positions(run.positions);
    run.max_speed = fastest(before, run.positions, frame);
    if (!std::isfinite(run.max_speed)) {
      std::ostringstream message;
      message << "a position is not finite at t = " << run.time << " s";
      throw Unstable(message.str());
    }
    for (std::size_t k = 0; k < solids.size(); ++k) {
      solids[k].place(obstaclePosition(scene.obstacles[k], run.time));
    }
    run.max_penetration = std::max(run.max_penetration, penetration(solids, run.positions));
    if (run.time > (run.instants.size() + 1) * scene.stop.time / kInstants - 0.5 * frame) {
      run.instants.push_back(measure(peer, scene, run.time, before, run.positions));
    }
    if (has_probe) run.probe.push_back({run.time, device, peer.probe(), peer.probeForce()});
    if (!(run.max_speed < scene.stop.rest_speed)) slow_since = run.time;
    if (scene.stop.rest_speed > 0.0 && run.time - slow_since >= kRestDuration - 0.5 * frame) {
      run.at_rest = true;
      break;
    }
  }
  return run;
}

json toJson(const Vec3& v) { return {v.x(), v.y(), v.z()}; }

/// Whether something other than gravity does work on the cloth.
bool isDriven(const Scene& scene) {
  const auto moves = [](const Pin& pin) { return pin.moves(); };
  const auto has_path = [](const Obstacle& obstacle) { return !obstacle.path.empty(); };
  return std::any_of(scene.cloth.pins.begin(), scene.cloth.pins.end(), moves) ||
         std::any_of(scene.obstacles.begin(), scene.obstacles.end(), has_path) ||
         !scene.probes[0].path.empty();
}

json summarise(const Peer& peer, const Scene& scene, const Run& run) {
  json summary = measureShape(scene, FinestMesh(scene, run.positions));
  summary["instants"] = json::array();
  double energy = run.start_energy, gained = 0.0;
  for (const Instant& instant : run.instants) {
    summary["instants"].push_back({{"time", instant.time},
                                   {"crossings", instant.crossings},
                                   {"stretch", instant.stretch},
                                   {"compression", instant.compression},
                                   {"energy", instant.energy},
                                   {"speed", instant.speed},
                                   {"extent", toJson(instant.extent)}});
    gained += std::max(0.0, instant.energy - energy);
    energy = instant.energy;
  }
  summary["start_energy"] = run.start_energy;
  summary["energy_gained"] = isDriven(scene) ? json() : json(gained);
  summary["stopped"] = run.stopped;
  summary["succeeded"] = true;
  summary["particles"] = scene.cloth.particles;
  summary["threads"] = 1;
  summary["processor"] = processorName();
  summary["simd"] = instructionSet();
  summary["simulated_time"] = run.time;
  summary["wall_time"] = run.wall_time;
  summary["real_time_factor"] = run.wall_time > 0.0 ? run.time / run.wall_time : 0.0;
  summary["steps"] = run.steps;
  summary["at_rest"] = run.at_rest;
  summary["max_speed"] = run.max_speed;
  summary["max_penetration"] = run.max_penetration;
  summary["probe_force"] = toJson(run.probe.empty() ? Vec3(Vec3::Zero()) : run.probe.back().force);
  summary["peer"] = peer.details();
  return summary;
}

std::ostream& operator<<(std::ostream& stream, const Vec3& v) {
  return stream << v.x() << ',' << v.y() << ',' << v.z();
}

std::ofstream open(const std::filesystem::path& file) {
  std::ofstream stream(file);
  if (!stream) throw std::runtime_error(file.string() + ": cannot be written");
  stream << std::setprecision(17);
  return stream;
}

void writeFiles(const std::filesystem::path& directory, const Scene& scene, const Run& run,
                const json& summary) {
  std::filesystem::create_directories(directory);
  std::ofstream particles = open(directory / "particles.csv");
  particles << "i,j,active,x,y,z\n";
  const int columns = scene.cloth.particles[kWarp];
  for (std::size_t p = 0; p < run.positions.size(); ++p) {
    particles << p % columns << ',' << p / columns << ",1," << run.positions[p] << '\n';
  }
  std::ofstream probe = open(directory / "probe.csv");
  probe << "time,device_x,device_y,device_z,proxy_x,proxy_y,proxy_z,force_x,force_y,force_z\n";
  for (const ProbeRow& row : run.probe) {
    probe << row.time << ',' << row.device << ',' << row.proxy << ',' << row.force << '\n';
  }
  open(directory / "summary.json") << summary.dump(2) << '\n';
}

/// @return false: help was printed instead
bool readArguments(int argc, char** argv, const char* name, const char* description, Arguments& arguments) {
  CommandLine line(name, description, "SCENE", arguments.scene, "scene file of the package (YAML)");
  line.add("set", arguments.overrides, "A.B=VALUE", "replaces a key of the scene; may be repeated");
  line.add("out", arguments.out, "DIR", "where summary.json, particles.csv and probe.csv go");
  line.add("solver", arguments.solver, "NAME", "which of the program's methods, where it has several");
  line.add("step", arguments.step, "TIME", "time step [s]; 0: the program decides");
  line.add("iterations", arguments.iterations, "N", "iterations a step");
  line.add("newton", arguments.newton, "N",
           "Newton steps of Bullet's deformable solver, of --iterations each");
  line.add("substeps", arguments.substeps, "N", "parts of a step");
  line.add("limit", arguments.limit, "TIME",
           "ends the run early when its steps have taken this long [s]; 0: never");
  if (!line.read(argc, argv)) return false;
  for (const auto& [option, value] :
       std::initializer_list<std::pair<const char*, double>>{{"--step", arguments.step},
                                                             {"--limit", arguments.limit},
                                                             {"--iterations", arguments.iterations},
                                                             {"--newton", arguments.newton},
                                                             {"--substeps", arguments.substeps}}) {
    if (!(value >= 0.0)) throw UsageError(std::string(option) + " must be >= 0");
  }
  return true;
}

/// Repeats an unstable run with half the step; only the last run counts.
int runScene(Arguments arguments, const MakePeer& make) {
  constexpr int kHalvings = 12;
  const Scene scene = loadScene(arguments.scene, arguments.overrides);
  for (int attempt = 0;; ++attempt) {
    const std::unique_ptr<Peer> peer = make(scene, arguments);
    try {
      const Run run = runToEnd(*peer, scene, arguments.limit);
      json summary = summarise(*peer, scene, run);
      summary["peer"]["halvings"] = attempt;
      if (!arguments.out.empty()) writeFiles(arguments.out, scene, run, summary);
      std::cout << summary.dump(2) << std::endl;
      return 0;
    } catch (const Unstable& error) {
      const json details = peer->details();
      if (attempt == kHalvings || !details.contains("step") || !details.value("halves", false)) throw;
      arguments.step = 0.5 * details["step"].get<double>();
      std::cerr << "unstable (" << error.what() << "): again with a step of " << arguments.step << " s"
                << std::endl;
    }
  }
}

}  // namespace

std::vector<Vec3> flatCloth(const Scene& scene) {
  const Grid grid = finestGrid(scene);
  std::vector<Vec3> positions(grid.particles());
  for (int p = 0; p < grid.particles(); ++p) {
    const Vec3 local((grid.column(p) - 0.5 * (grid.columns - 1)) * grid.dx,
                     (grid.row(p) - 0.5 * (grid.rows - 1)) * grid.dy, 0.0);
    positions[p] = scene.cloth.pose.position + scene.cloth.pose.orientation * local;
  }
  return positions;
}

std::vector<double> particleMasses(const Scene& scene) {
  const Grid grid = finestGrid(scene);
  std::vector<double> masses(grid.particles());
  for (int p = 0; p < grid.particles(); ++p) {
    const bool side_x = grid.column(p) == 0 || grid.column(p) == grid.columns - 1;
    const bool side_y = grid.row(p) == 0 || grid.row(p) == grid.rows - 1;
    masses[p] =
        scene.cloth.fabric.areal_density * grid.dx * grid.dy * (side_x ? 0.5 : 1.0) * (side_y ? 0.5 : 1.0);
  }
  return masses;
}

std::vector<char> pinnedParticles(const Scene& scene) {
  const Grid grid = finestGrid(scene);
  std::vector<char> pinned(grid.particles(), 0);
  for (const Pin& range : scene.cloth.pins) {
    for (int j = range.j0; j <= range.j1; ++j) {
      for (int i = range.i0; i <= range.i1; ++i) pinned[grid.particle(i, j)] = 1;
    }
  }
  return pinned;
}

Vec3 MovedParticle::position(double time) const {
  const double rate = pin.turn.norm();
  Vec3 arm = start - pin.centre;
  if (rate > 0.0) arm = Eigen::AngleAxisd(rate * time, pin.turn / rate) * arm;
  return pin.centre + time * pin.velocity + arm;
}

std::vector<MovedParticle> movedParticles(const Scene& scene) {
  const Grid grid = finestGrid(scene);
  const std::vector<Vec3> flat = flatCloth(scene);
  std::vector<char> taken(grid.particles(), 0);  // a particle of several pins belongs to the first
  std::vector<MovedParticle> moved;
  for (const Pin& pin : scene.cloth.pins) {
    for (int j = pin.j0; j <= pin.j1; ++j) {
      for (int i = pin.i0; i <= pin.i1; ++i) {
        const int p = grid.particle(i, j);
        if (!taken[p] && pin.moves()) moved.push_back({p, pin, flat[p]});
        taken[p] = 1;
      }
    }
  }
  return moved;
}

bool grasps(const Scene& scene, double time) {
  const auto& times = scene.probes[0].grasp;
  return std::any_of(times.begin(), times.end(),
                     [time](const auto& t) { return t[0] <= time && time < t[1]; });
}

std::vector<int> touchedParticles(const Scene& scene, const std::vector<Vec3>& positions, const Vec3& place) {
  constexpr double kSlack = 2e-4;  // [m]
  constexpr int kParts = 4;        // sides of a cell are divided in so many parts
  const double reach = scene.probes[0].radius + scene.cloth.fabric.thickness + kSlack;
  const Grid grid = finestGrid(scene);
  std::vector<char> touched(positions.size(), 0);
  for (int j = 0; j + 1 < grid.rows; ++j) {
    for (int i = 0; i + 1 < grid.columns; ++i) {
      const std::array<int, 4> c{grid.particle(i, j), grid.particle(i + 1, j), grid.particle(i, j + 1),
                                 grid.particle(i + 1, j + 1)};
      double least = reach;
      for (int k = 0; k < (kParts + 1) * (kParts + 1); ++k) {
        const double u = static_cast<double>(k % (kParts + 1)) / kParts;
        const double v = static_cast<double>(k / (kParts + 1)) / kParts;
        const Vec3 x = (1 - u) * (1 - v) * positions[c[0]] + u * (1 - v) * positions[c[1]] +
                       (1 - u) * v * positions[c[2]] + u * v * positions[c[3]];
        least = std::min(least, (x - place).norm());
      }
      for (int p : c) touched[p] |= least < reach ? 1 : 0;
    }
  }
  std::vector<int> particles;
  for (std::size_t p = 0; p < touched.size(); ++p) {
    if (touched[p]) particles.push_back(static_cast<int>(p));
  }
  return particles;
}

Vec3 obstaclePosition(const Obstacle& obstacle, double time) {
  return obstacle.path.empty() ? obstacle.pose.position : pathPosition(obstacle.path, time);
}

double secant(const Loop& law, double s, double least) {
  if (std::abs(s) < least) s = s < 0.0 ? -least : least;
  const double zero = 0.5 * (law.upper()(0.0).force + law.lower()(0.0).force);
  return (0.5 * (law.upper()(s).force + law.lower()(s).force) - zero) / s;
}

int runPeer(int argc, char** argv, const char* name, const char* description, const MakePeer& make) {
  Arguments arguments;
  try {
    return readArguments(argc, argv, name, description, arguments) ? runScene(arguments, make) : 0;
  } catch (const UsageError& error) {
    std::cerr << name << ": " << error.what() << " (see --help)" << std::endl;
    return 2;
  } catch (const InputError& error) {
    std::cerr << error.what() << std::endl;
    return 2;
  } catch (const std::exception& error) {
    std::cerr << name << ": " << error.what() << std::endl;
    return 3;
  }
}

}  // namespace peers
}  // namespace haptic_cloth
