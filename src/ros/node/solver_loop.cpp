#include "ros/node/solver_loop.h"

#include <ros/console.h>
#include <ros/time.h>

#include <algorithm>
#include <thread>
#include <utility>

#include "ros/node/steady_clock.h"

namespace haptic_cloth {
namespace {

constexpr double kIdle = 1e-3;   ///< sleep while paused [s]
constexpr double kWindow = 1.0;  ///< window of the statistics [s]

/// If the scene does not set the number of threads, one core is left for the haptic thread.
Scene sceneFor(Scene scene) {
  const int cores = static_cast<int>(std::thread::hardware_concurrency());
  if (scene.solver.threads == 0) scene.solver.threads = std::max(1, cores - 1);
  return scene;
}

}  // namespace

SolverLoop::SolverLoop(const NodeOptions& options, SharedState& shared, RecordFile recording)
    : shared_(shared),
      live_(shared.live_for_solver),
      simulation_(sceneFor(options.scene)),
      targets_seen_(options.scene.obstacles.size(), 0),
      motions_(options.scene.obstacles.size()),
      probes_(options.probes),
      pacer_(simulation_, options.pace) {
  window_.meets_itself = simulation_.meetsItself();
  if (recording == nullptr) return;
  recorder_.emplace(options.record, std::move(recording));
  simulation_.record([this](const std::string& line) { recorder_->write(line); });
}

void SolverLoop::run() {
  while (!shared_.stop) {
    shared_.tasks.work(*this);
    shared_.recording = recorder_ && recorder_->isOpen();
    copyFrameWhenWanted();
    if (shared_.paused) {
      pacer_.restart();
      if (window_start_ >= 0.0) endWindow();
      for (SharedProbe& probe : shared_.probes) probe.session().pause(simulation_);
      for (ObstacleMotion& motion : motions_) motion.interrupt();
      sleepUntil(steadyNow() + kIdle);
      continue;
    }
    sleepUntil(pacer_.due(steadyNow()));
    takeOptions();
    const int length = pacer_.begin(simulation_, steadyNow());
    moveObstacles(length * simulation_.scene().solver.time_step);
    for (SharedProbe& probe : shared_.probes) {
      probe.session().beforeStep(simulation_, steadyNow(), length);
    }
    const StepReport report = simulation_.step(length);
    for (SharedProbe& probe : shared_.probes) probe.session().afterStep(simulation_, steadyNow());
    pacer_.end(report, steadyNow());
    record(report);
  }
  simulation_.record(nullptr);
}

void SolverLoop::reset() {
  simulation_.reset();
  startAgain();
}

std::string SolverLoop::saveState() {
  skipRamps();
  return simulation_.saveState();
}

/// Loads a state. The devices may have been elsewhere when it was saved. No probe may find itself
/// holding cloth or on the other side of it, so probes enter the scene again as after silence.
void SolverLoop::loadState(const std::string& state, const std::string& origin) {
  skipRamps();
  simulation_.loadState(state, origin);
  if (recorder_ && recorder_->end()) ROS_WARN("the recording ends: a state was loaded");
  startAgain();
}

/// Forgets what probes and obstacles were told for another cloth.
void SolverLoop::startAgain() {
  for (SharedProbe& probe : shared_.probes) probe.session().restart(simulation_);
  // Targets sent before are not used.
  for (std::size_t k = 0; k < targets_seen_.size(); ++k) {
    targets_seen_[k] = shared_.obstacles[k].read().number;
    motions_[k].stop();
  }
  pacer_.restart();
  last_ = StepReport();
  last_.active_particles = simulation_.activeParticles();
  window_.iterations = 0.0;
  endWindow();
  shared_.frame_wanted = true;
  copyFrameWhenWanted();
}

/// Takes new live options between two steps. They were validated as a whole.
void SolverLoop::takeOptions() {
  if (!live_.readNew()) return;
  const NodeOptions& asked = *live_.newest().options;
  probes_ = asked.probes;
  SolverOptions solver = asked.scene.solver;
  solver.threads = simulation_.scene().solver.threads;
  pacer_.setOptions(solver, asked.scene.adapt, asked.scene.air_damping, asked.pace);
}

/// Takes the newest options as they were asked for, with couplings at the ends of their ramps. No step
/// uses these: before the next step its quality and the couplings of the haptic thread are set.
void SolverLoop::skipRamps() {
  takeOptions();
  pacer_.restoreQuality(simulation_);
  const LiveOptions& live = live_.newest();
  for (std::size_t k = 0; k < live.gains.size(); ++k) {
    const ProbeOptions& asked = live.options->scene.probes[k];
    simulation_.setCoupling(static_cast<int>(k), asked.coupling_stiffness, asked.coupling_damping);
  }
}

void SolverLoop::copyFrameWhenWanted() {
  if (!shared_.frame_wanted.exchange(false)) return;
  frame_.taken = steadyNow();
  frame_.stamp = ros::Time::now();
  frame_.time = simulation_.time();
  simulation_.positions(frame_.positions);
  simulation_.cells(frame_.cells);
  simulation_.cellLoads(frame_.tension, frame_.bending);
  frame_.probes.clear();
  for (std::size_t k = 0; k < shared_.probes.size(); ++k) {
    const ProbeSession& session = shared_.probes[k].session();
    frame_.probes.push_back(
        {simulation_.probe(static_cast<int>(k)), session.orientation(), session.grasp(), forceError(k)});
  }
  frame_.obstacles.clear();
  for (std::size_t k = 0; k < targets_seen_.size(); ++k) {
    frame_.obstacles.push_back(simulation_.obstaclePose(static_cast<int>(k)));
  }
  frame_.quality = pacer_.quality();
  frame_.failed = failed_;
  frame_.last = last_;
  shared_.frame.write(frame_);
}

/// Estimated error of the force on the hand [N].
double SolverLoop::forceError(std::size_t probe) const {
  return probes_[probe].device.force_scale * simulation_.probe(static_cast<int>(probe)).force_error;
}

/// @param length of the next step [s]
void SolverLoop::moveObstacles(double length) {
  for (std::size_t k = 0; k < targets_seen_.size(); ++k) {
    const int obstacle = static_cast<int>(k);
    const ObstacleTarget& target = shared_.obstacles[k].read();
    if (target.number != targets_seen_[k]) motions_[k].aim(target.pose, simulation_.time());
    targets_seen_[k] = target.number;
    if (motions_[k].isOnItsWay())
      simulation_.moveObstacle(obstacle, motions_[k].advance(simulation_.obstaclePose(obstacle), length));
  }
}

void SolverLoop::record(const StepReport& report) {
  const double now = steadyNow();
  last_ = report;
  if (report.failed) failed_.note(report.minimizer.why, now);
  if (!report.failed && report.minimizer.motion_made < 1.0) ++failed_.made_in_part;
  if (window_start_ < 0.0) {
    window_start_ = now;
    window_start_time_ = simulation_.time();
    window_start_slipped_ = pacer_.quality().slipped;
    window_.steps = 0;
    window_iterations_ = 0.0;
    window_.taken = now;
    writeStats();
    return;
  }
  ++window_.steps;
  window_iterations_ += report.minimizer.iterations;
  if (now - window_start_ < kWindow) return;
  window_.taken = now;
  window_.wall = now - window_start_;
  window_.real_time_factor = (simulation_.time() - window_start_time_) / window_.wall;
  window_.slipped_share = (pacer_.quality().slipped - window_start_slipped_) / window_.wall;
  window_.iterations = window_iterations_ / window_.steps;
  writeStats();
  window_start_ = now;
  window_start_time_ = window_.time;
  window_start_slipped_ = window_.quality.slipped;
  window_.steps = 0;
  window_iterations_ = 0.0;
}

/// Ends the window before its time, because no step follows or the cloth is another.
void SolverLoop::endWindow() {
  window_start_ = -1.0;
  window_.wall = 0.0;
  window_.slipped_share = 0.0;
  writeStats();
}

/// Writes the statistics with the values of the cloth as it is.
void SolverLoop::writeStats() {
  window_.time = simulation_.time();
  window_.quality = pacer_.quality();
  window_.kinetic = simulation_.energy().kinetic;
  window_.force_errors.clear();
  for (std::size_t k = 0; k < shared_.probes.size(); ++k) {
    window_.force_errors.push_back(forceError(k));
  }
  window_.failed = failed_;
  window_.last = last_;
  shared_.solver_stats.write(window_);
}

}  // namespace haptic_cloth
