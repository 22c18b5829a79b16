#include "peer.h"

#include <algorithm>
#include <chrono>
#include <cmath>
#include <filesystem>
#include <fstream>
#include <iomanip>
#include <iostream>

#include "contact/solid.h"
#include "energy/internal_energy.h"
#include "haptic_cloth/error.h"
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

/// One run; the wall time is that of the peer's steps alone.
struct Run {
  double wall_time = 0.0, time = 0.0;
  int steps = 0;
  bool at_rest = false;
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

double fastest(const std::vector<Vec3>& before, const std::vector<Vec3>& after, double duration) {
  double largest = 0.0;
  for (std::size_t p = 0; p < after.size(); ++p) {
    const double moved = (after[p] - before[p]).norm();
    if (!std::isfinite(moved)) throw Unstable("a position is not finite");
    largest = std::max(largest, moved);
  }
  return largest / duration;
}

/// Runs by the rules of `simulate`: until stop.time, or until all particles have been slow for 0.1
/// s.
Run runToEnd(Peer& peer, const Scene& scene) {
  constexpr double kRestDuration = 0.1;  // [s]
  const std::vector<Solid> solids(scene.obstacles.begin(), scene.obstacles.end());
  const bool has_probe = !scene.probes[0].path.empty();
  const double frame = peer.frame();
  Run run;
  std::vector<Vec3> before;
  peer.positions(run.positions);
  double slow_since = 0.0;
  while (run.time < scene.stop.time - 0.5 * frame) {
    const Vec3 from = pathPosition(scene.probes[0].path, run.time);
    const Vec3 device = pathPosition(scene.probes[0].path, run.time + frame);
    before.swap(run.positions);
    const auto start = std::chrono::steady_clock::now();
    peer.step(has_probe ? &device : nullptr, (device - from) / frame);
    run.wall_time += std::chrono::duration<double>(std::chrono::steady_clock::now() - start).count();
    run.time = ++run.steps * frame;
    peer.positions(run.positions);
    run.max_speed = fastest(before, run.positions, frame);
    run.max_penetration = std::max(run.max_penetration, penetration(solids, run.positions));
    if (has_probe) run.probe.push_back({run.time, device, peer.probe(), peer.probeForce()});
    if (!(run.max_speed < scene.stop.rest_speed)) slow_since = run.time;
    if (scene.stop.rest_speed > 0.0 && run.time - slow_since >= kRestDuration - 0.5 * frame) {
      run.at_rest = true;
      break;
    }
  }
  return run;
}

/// Energies of a shape by the package's own laws on the finest mesh, and strains along its threads.
json measureShape(const Scene& scene, const std::vector<Vec3>& positions) {
  const LeafMesh leaves(finestGrid(scene), scene.cloth.pins, 0);
  const ActiveMesh mesh(leaves, scene.cloth.fabric.areal_density);
  InternalEnergy internal(scene.cloth.fabric, mesh);
  Field x;
  x.resize(mesh.nodes());
  double gravity = 0.0;
  for (int n = 0; n < mesh.nodes(); ++n) {
    x.set(n, positions[mesh.particle[n]]);
    gravity -= mesh.mass[n] * scene.gravity.dot(x[n]);
  }
  double sum = 0.0, weights = 0.0, largest = 0.0;
  for (const Edge& edge : mesh.edges) {
    const double strain = (x[edge.b] - x[edge.a]).norm() / edge.length - 1.0;
    sum += edge.width * edge.length * std::abs(strain);
    weights += edge.width * edge.length;
    largest = std::max(largest, std::abs(strain));
  }
  internal.setNormals(x);
  const InternalEnergy::Energy e = internal.evaluate(0, internal.size(), x);
  return {{"energy",
           {{"gravity", gravity},
            {"stretch", e.stretch},
            {"bend", e.bend},
            {"shear", e.shear},
            {"contact", 0.0}}},
          {"max_strain", largest},
          {"mean_strain", weights > 0.0 ? sum / weights : 0.0}};
}

json summarise(const Peer& peer, const Scene& scene, const Run& run) {
  json summary = measureShape(scene, run.positions);
  summary["succeeded"] = true;
  summary["particles"] = scene.cloth.particles;
  summary["threads"] = 1;
  summary["simulated_time"] = run.time;
  summary["wall_time"] = run.wall_time;
  summary["real_time_factor"] = run.wall_time > 0.0 ? run.time / run.wall_time : 0.0;
  summary["steps"] = run.steps;
  summary["at_rest"] = run.at_rest;
  summary["max_speed"] = run.max_speed;
  summary["max_penetration"] = run.max_penetration;
  const Vec3 force = run.probe.empty() ? Vec3(Vec3::Zero()) : run.probe.back().force;
  summary["probe_force"] = {force.x(), force.y(), force.z()};
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
  if (!line.read(argc, argv)) return false;
  for (const auto& [option, value] :
       std::initializer_list<std::pair<const char*, double>>{{"--step", arguments.step},
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
      const Run run = runToEnd(*peer, scene);
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
