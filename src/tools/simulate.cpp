/// simulate: runs a scene file without ROS and writes what happened.
#include <unistd.h>

#include <chrono>
#include <cstdint>
#include <cstdio>
#include <filesystem>
#include <fstream>
#include <iostream>
#include <optional>
#include <string>
#include <vector>

#include "haptic_cloth/error.h"
#include "haptic_cloth/scene.h"
#include "haptic_cloth/simulation.h"
#include "haptic_cloth/state_file.h"
#include "scene/scene_options.h"
#include "sim/recording.h"
#include "state/new_file.h"
#include "state/number_text.h"
#include "tools/command_line.h"
#include "tools/outputs.h"
#include "tools/run.h"
#include "tools/run_tool.h"
#include "tools/standard_output.h"
#include "tools/summary.h"

namespace {

using haptic_cloth::RunRecord;
using haptic_cloth::RunTotals;
using haptic_cloth::Simulation;

/// A run with a larger share of failed steps has not simulated its scene.
constexpr double kMaxFailedShare = 0.1;

constexpr const char* kDescription =
    "Simulates a piece of cloth from a scene file, without ROS.\n"
    "Example: simulate drape.yaml --set solver.threads=2 --set stop.time=1 --out result";

constexpr const char* kFooter =
    "Files in DIR (SI units):\n"
    "  summary.json   times, counts, energies, forces, hash of the final state\n"
    "  steps.csv      a row for each step: iterations, termination, energies, mesh events\n"
    "  probe.csv      time, device x y z, proxy x y z, force on the probe x y z, torque\n"
    "                 on it about the proxy x y z, error of the force; of several, probe_NAME.csv\n"
    "  particles.csv  i,j,active,x,y,z for every particle of the finest grid\n"
    "  mesh.ply       the active mesh as triangles\n"
    "With --real-time the results depend on the machine, and steps.csv has no rows: energies take time.\n"
    "To continue from a state, let it stop later: simulate drape.yaml --save-state drape.state, then\n"
    "simulate drape.yaml --resume drape.state --set stop.time=4. The files then describe the second run\n"
    "only.\n"
    "Exit status:\n"
    "  0   success\n"
    "  2   bad input; nothing is written\n"
    "  3   the simulation failed: a final state that is not finite, more than 10 % of the steps failed, or\n"
    "      a replay that ends in another state than its recording. Files are written; a state only if it\n"
    "      is finite\n"
    "  4   output cannot be written, for instance because the disk is full. Then none of the files of\n"
    "      this run is there; they are whole if only the report cannot be printed";

struct Arguments {
  std::string scene;
  std::vector<std::string> overrides;
  std::string out;
  std::string resume, save_state, replay;
  bool real_time = false;
};

/// One line on a terminal, rewritten a few times a second; nothing when stderr is a file or pipe.
class Progress {
 public:
  explicit Progress(double end_time) : end_time_(end_time), enabled_(isatty(STDERR_FILENO) != 0) {}

  void show(const Simulation& simulation, const RunTotals& totals) {
    const auto now = std::chrono::steady_clock::now();
    if (!enabled_ || now < next_) return;
    next_ = now + std::chrono::milliseconds(200);
    std::fprintf(stderr, "\r%8.3f / %.3f s  %6d particles  %5d iterations  real-time factor %-8.3g",
                 simulation.time(), end_time_, simulation.activeParticles(), totals.last.minimizer.iterations,
                 haptic_cloth::realTimeFactor(simulation, totals));
    shown_ = true;
  }

  void finish() const {
    if (shown_) std::fputc('\n', stderr);
  }

 private:
  double end_time_;
  bool enabled_;
  bool shown_ = false;
  std::chrono::steady_clock::time_point next_{};
};

/// Tables of all keys, as in docs/reference/scenes.md.
std::string optionsPage() {
  std::string page;
  for (const auto& [title, table] : haptic_cloth::sceneTables()) page += "# " + title + "\n\n" + table + '\n';
  return page;
}

/// @return false: help or the keys were printed instead
bool readArguments(int argc, char** argv, Arguments& arguments) {
  haptic_cloth::CommandLine line("simulate", kDescription, "SCENE", arguments.scene, "scene file (YAML)");
  line.add("set", arguments.overrides, "A.B=VALUE", "replaces a key of the scene; may be repeated");
  line.add("out", arguments.out, "DIR", "directory for the results, created if need be");
  line.add("resume", arguments.resume, "FILE",
           "continues from a saved state of this scene, as if it had not stopped");
  line.add("save-state", arguments.save_state, "FILE", "writes the state at the end, for --resume");
  line.add("replay", arguments.replay, "FILE",
           "repeats a recording of the node (~record) instead of the scene's paths and stop");
  line.addFlag("real-time", arguments.real_time,
               "keeps the clock as the node does: a late solver takes longer and coarser steps");
  line.addPage("options", optionsPage(), "prints the keys of a scene as Markdown, and exits");
  line.setFooter(kFooter);
  return line.read(argc, argv);
}

/// A run of less than one step would do nothing.
/// @throws InputError
void checkTimeStep(const haptic_cloth::Scene& scene, const std::string& file) {
  using haptic_cloth::shortestText;
  if (scene.solver.time_step <= scene.stop.time) return;
  throw haptic_cloth::InputError(file, "solver.time_step", shortestText(scene.solver.time_step),
                                 "must be at most stop.time = " + shortestText(scene.stop.time));
}

int simulate(const Arguments& arguments) {
  if (arguments.real_time && !arguments.replay.empty()) {
    throw haptic_cloth::UsageError("--real-time: cannot be combined with --replay");
  }
  if (!arguments.resume.empty() && !arguments.replay.empty()) {
    throw haptic_cloth::UsageError("--resume: cannot be combined with --replay, which begins at time 0");
  }
  Simulation simulation(haptic_cloth::loadScene(arguments.scene, arguments.overrides));
  if (arguments.replay.empty()) checkTimeStep(simulation.scene(), arguments.scene);
  if (!arguments.resume.empty()) {
    const std::uint64_t most = haptic_cloth::largestState(simulation.scene());
    simulation.loadState(haptic_cloth::readStateFile(arguments.resume, most), arguments.resume);
  }
  std::ifstream recording;
  std::optional<haptic_cloth::Replay> replay;
  if (!arguments.replay.empty()) {
    if (!std::filesystem::is_regular_file(arguments.replay)) {
      throw haptic_cloth::InputError(arguments.replay, "", "", "must be a regular file that exists");
    }
    const double budget = simulation.scene().solver.minimizer.time_budget;
    if (budget > 0.0) {
      throw haptic_cloth::InputError(arguments.scene, "solver.time_budget",
                                     haptic_cloth::shortestText(budget),
                                     "must be 0 for --replay: a clock cannot be repeated");
    }
    recording.open(arguments.replay);
    replay.emplace(recording, arguments.replay, simulation);
  }
  if (!arguments.save_state.empty()) haptic_cloth::checkStateFile(arguments.save_state);
  if (!arguments.out.empty())
    haptic_cloth::prepareDirectory(arguments.out, simulation.scene(), arguments.save_state);

  const auto rows = arguments.out.empty() ? haptic_cloth::Rows::None
                    : arguments.real_time ? haptic_cloth::Rows::Probes
                                          : haptic_cloth::Rows::All;
  Progress progress(simulation.scene().stop.time);
  const auto show = [&](const Simulation& now, const RunTotals& totals) { progress.show(now, totals); };
  const auto next = [&](Simulation& now, int& length) { return replay->next(now, length); };
  const RunRecord record = replay                ? haptic_cloth::runSteps(simulation, rows, next, show)
                           : arguments.real_time ? haptic_cloth::runInRealTime(simulation, rows, show)
                                                 : haptic_cloth::runScene(simulation, rows, show);
  progress.finish();

  const RunTotals& totals = record.totals;
  const bool finite = haptic_cloth::isFinite(simulation);
  const bool succeeded = finite && totals.failed_steps <= kMaxFailedShare * totals.steps;
  haptic_cloth::NewFiles files;
  if (!arguments.out.empty()) haptic_cloth::writeOutputs(arguments.out, simulation, record, succeeded, files);
  if (!arguments.save_state.empty() && finite) {
    haptic_cloth::checkStateFile(arguments.save_state);  // it may be another one by now
    files.add(arguments.save_state).stream() << simulation.saveState();
  }
  files.publish();
  const std::string difference = replay ? replay->difference(simulation) : "";
  if (arguments.out.empty()) std::cout << haptic_cloth::briefReport(simulation, totals) << '\n';
  if (replay && difference.empty()) std::cout << arguments.replay << ": replayed to the same state\n";
  haptic_cloth::requireStandardOutput();
  if (!difference.empty()) std::cerr << difference << std::endl;
  if (succeeded) return difference.empty() ? haptic_cloth::kSuccess : haptic_cloth::kFailed;
  std::cerr << arguments.scene << ": simulation failed: "
            << (finite ? std::to_string(totals.failed_steps) + " of " + std::to_string(totals.steps) +
                             " steps were restored"
                       : std::string("the final state is not finite"))
            << std::endl;
  return haptic_cloth::kFailed;
}

int run(int argc, char** argv) {
  Arguments arguments;
  return readArguments(argc, argv, arguments) ? simulate(arguments) : haptic_cloth::kSuccess;
}

}  // namespace

int main(int argc, char** argv) { return haptic_cloth::runTool("simulate", run, argc, argv); }
