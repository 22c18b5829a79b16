#include "tools/outputs.h"

#include <functional>
#include <string>
#include <vector>

#include "haptic_cloth/error.h"
#include "tools/summary.h"

namespace haptic_cloth {
namespace {

namespace fs = std::filesystem;

// The rest of the names depends on the scene.
constexpr const char* kSteps = "steps.csv";
constexpr const char* kParticles = "particles.csv";
constexpr const char* kMesh = "mesh.ply";
constexpr const char* kSummary = "summary.json";

std::string probeFile(const ProbeOptions& probe) {
  return probe.name == ProbeOptions().name ? probe.name + ".csv" : "probe_" + probe.name + ".csv";
}

void writeFile(NewFiles& files, const fs::path& name, const std::function<void(std::ostream&)>& write) {
  NewFile& file = files.add(name);
  write(file.stream());
  // A full disk is noticed here, not after the other files.
  file.finish();
}

std::ostream& operator<<(std::ostream& stream, const Vec3& v) {
  return stream << v.x() << ',' << v.y() << ',' << v.z();
}

void writeSteps(std::ostream& stream, const std::vector<StepRecord>& steps) {
  stream << "time,active_particles,awake_particles,iterations,evaluations,restarts,termination,residual,"
            "kinetic,gravity,"
            "stretch,bend,shear,contact,coupling,dissipated,refined,coarsened,failed,velocity_scale,"
            "max_penetration,adapt_time,wall_time\n";
  for (const StepRecord& row : steps) {
    const StepReport& report = row.report;
    const MinimizerReport& minimizer = report.minimizer;
    const EnergyReport& energy = row.energy;
    stream << report.time << ',' << report.active_particles << ',' << report.awake_particles << ','
           << minimizer.iterations << ',' << minimizer.evaluations << ',' << minimizer.restarts << ','
           << toString(minimizer.why) << ',' << minimizer.residual << ',' << energy.kinetic << ','
           << energy.gravity << ',' << energy.stretch << ',' << energy.bend << ',' << energy.shear << ','
           << energy.contact << ',' << energy.coupling << ',' << energy.dissipated << ',' << report.refined
           << ',' << report.coarsened << ',' << report.failed << ',' << report.velocity_scale << ','
           << report.max_penetration << ',' << report.adapt_seconds << ',' << row.wall_time << '\n';
  }
}

void writeProbe(std::ostream& stream, const std::vector<ProbeRecord>& probe) {
  stream << "time,device_x,device_y,device_z,proxy_x,proxy_y,proxy_z,force_x,force_y,force_z,"
            "torque_x,torque_y,torque_z,force_error\n";
  for (const ProbeRecord& row : probe) {
    stream << row.time << ',' << row.probe.device << ',' << row.probe.proxy << ',' << row.probe.force << ','
           << row.probe.torque << ',' << row.probe.force_error << '\n';
  }
}

void writeParticles(std::ostream& stream, const Simulation& simulation) {
  std::vector<Vec3> positions;
  std::vector<char> active;
  simulation.positions(positions);
  simulation.activeFlags(active);
  const int columns = simulation.scene().cloth.particles[kWarp];
  stream << "i,j,active,x,y,z\n";
  for (std::size_t p = 0; p < positions.size(); ++p) {
    stream << p % columns << ',' << p / columns << ',' << (active[p] ? 1 : 0) << ',' << positions[p] << '\n';
  }
}

void writeMesh(std::ostream& stream, const Simulation& simulation) {
  std::vector<Vec3> positions;
  std::vector<CellView> cells;
  simulation.positions(positions);
  simulation.cells(cells);
  std::vector<int> vertex_of(positions.size(), -1);
  std::vector<int> particle_of;
  for (const CellView& cell : cells) {
    for (const int particle : cell.particles) {
      if (vertex_of[particle] >= 0) continue;
      vertex_of[particle] = static_cast<int>(particle_of.size());
      particle_of.push_back(particle);
    }
  }
  stream << "ply\nformat ascii 1.0\nelement vertex " << particle_of.size()
         << "\nproperty double x\nproperty double y\nproperty double z\nelement face " << 2 * cells.size()
         << "\nproperty list uchar int vertex_indices\nend_header\n";
  for (const int particle : particle_of) {
    const Vec3& x = positions[particle];
    stream << x.x() << ' ' << x.y() << ' ' << x.z() << '\n';
  }
  for (const CellView& cell : cells) {
    const auto triangle = [&](int a, int b, int c) {
      const auto& corners = cell.particles;
      stream << "3 " << vertex_of[corners[a]] << ' ' << vertex_of[corners[b]] << ' ' << vertex_of[corners[c]]
             << '\n';
    };
    triangle(0, 1, cell.diagonal_rises ? 3 : 2);
    cell.diagonal_rises ? triangle(0, 3, 2) : triangle(1, 3, 2);
  }
}

}  // namespace

void prepareDirectory(const fs::path& directory, const Scene& scene, const fs::path& state_file) {
  std::error_code error;
  fs::create_directories(directory, error);
  if (!error && !fs::is_directory(directory)) error = std::make_error_code(std::errc::not_a_directory);
  if (error) throw InputError("--out", "", directory.string(), "must be a directory: " + error.message());
  std::vector<std::string> names{kSteps, kParticles, kMesh, kSummary};
  for (const ProbeOptions& probe : scene.probes) names.push_back(probeFile(probe));
  for (const std::string& name : names) {
    if (!state_file.empty() && linkedFile(directory / name) == linkedFile(state_file))
      throw InputError("--save-state", "", state_file.string(), "must not be a result of --out");
    checkNewFile(directory / name);
  }
  const NewFile trial(directory / kSummary);  // better now than after an hour of simulation
}

void writeOutputs(const fs::path& directory, const Simulation& simulation, const RunRecord& record,
                  bool succeeded, NewFiles& files) {
  const auto write = [&](const std::string& name, const std::function<void(std::ostream&)>& content) {
    writeFile(files, directory / name, content);
  };
  write(kSteps, [&](std::ostream& stream) { writeSteps(stream, record.steps); });
  for (std::size_t k = 0; k < record.probes.size(); ++k) {
    write(probeFile(simulation.scene().probes[k]),
          [&](std::ostream& stream) { writeProbe(stream, record.probes[k]); });
  }
  write(kParticles, [&](std::ostream& stream) { writeParticles(stream, simulation); });
  write(kMesh, [&](std::ostream& stream) { writeMesh(stream, simulation); });
  write(kSummary,
        [&](std::ostream& stream) { stream << summaryJson(simulation, record.totals, succeeded) << '\n'; });
}

}  // namespace haptic_cloth
