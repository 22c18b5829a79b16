#include "ros/display/display_thread.h"

#include <diagnostic_msgs/DiagnosticArray.h>

#include <algorithm>

#include "ros/display/diagnostics.h"
#include "ros/display/prepared_message.h"
#include "ros/node/conversions.h"
#include "ros/node/steady_clock.h"

namespace haptic_cloth {
namespace {

constexpr double kDiagnosticsPeriod = 1.0;  ///< [s]

/// Whether a periodic task is due. If so, advances `due`; missed periods are not made up.
bool isDue(double now, double period, double& due) {
  if (now < due) return false;
  due = std::max(due + period, now);
  return true;
}

/// Whether an output shows this frame: not if it is from before its subscribers came. Updates `since`.
/// @param watched whether the output has subscribers  @param since first round with them, steady
/// clock [s]; < 0: none
bool isShown(const DisplayFrame& frame, bool watched, double now, double& since) {
  if (!watched) {
    since = -1.0;
  } else if (since < 0.0) {
    since = now;
  }
  return watched && frame.taken >= since;
}

}  // namespace

DisplayThread::DisplayThread(const NodeOptions& options, const DisplayPublishers& publishers,
                             const DisplaySources& sources, SharedState& shared)
    : frame_id_(options.frame_id),
      columns_(options.scene.cloth.particles[0]),
      rows_(options.scene.cloth.particles[1]),
      markers_period_(1.0 / options.markers.rate),
      state_period_(1.0 / options.state_rate),
      publishers_(publishers),
      sources_(sources),
      shared_(shared),
      live_(shared.live_for_display),
      builder_(options.scene, options.frame_id, options.markers) {}

void DisplayThread::run() {
  markers_due_ = state_due_ = steadyNow();
  double diagnostics_due = steadyNow() + kDiagnosticsPeriod;
  while (!shared_.stop) {
    sleepUntil(std::min({markers_due_, state_due_, diagnostics_due}));
    takeOptions();
    const double now = steadyNow();
    const bool markers = isDue(now, markers_period_, markers_due_);
    const bool state = isDue(now, state_period_, state_due_);
    const bool picture = markers && publishers_.markers.getNumSubscribers() > 0;
    const bool mesh = state && publishers_.state.getNumSubscribers() > 0;
    const bool proxy = state && proxiesWanted();
    // The solver answers this request with a copy that is shown in the next round. So a frame is
    // one round old, and neither thread waits.
    const DisplayFrame& frame = shared_.frame.read();
    if (picture || mesh || proxy) shared_.frame_wanted = true;
    if (markers && isShown(frame, picture, now, markers_since_)) publishMarkers(frame);
    if (state && isShown(frame, mesh || proxy, now, state_since_)) {
      if (mesh) publishState(frame);
      if (proxy) publishProxies(frame);
    }
    if (isDue(now, kDiagnosticsPeriod, diagnostics_due)) publishDiagnostics(now);
  }
}

void DisplayThread::takeOptions() {
  if (!live_.readNew()) return;
  const LiveOptions& live = live_.newest();
  builder_.setOptions(live.options->markers);
  markers_period_ = 1.0 / live.options->markers.rate;
  state_period_ = 1.0 / live.options->state_rate;
  // A deadline set by a slow rate is moved forward to the new rate.
  markers_due_ = std::min(markers_due_, steadyNow() + markers_period_);
  state_due_ = std::min(state_due_, steadyNow() + state_period_);
}

void DisplayThread::publishMarkers(const DisplayFrame& frame) {
  forces_.clear();
  for (SharedProbe& probe : shared_.probes) forces_.push_back(probe.felt.read().force);
  publishers_.markers.publish(PreparedMessage(builder_.build(frame, forces_, frame.stamp)));
  ++marker_frames_;
}

void DisplayThread::publishState(const DisplayFrame& frame) {
  toClothState(frame, columns_, rows_, scratch_, state_);
  state_.header.stamp = frame.stamp;
  state_.header.frame_id = frame_id_;
  publishers_.state.publish(PreparedMessage(state_));
  ++state_frames_;
}

bool DisplayThread::proxiesWanted() const {
  return std::any_of(sources_.probes.begin(), sources_.probes.end(),
                     [](const ProbeTopics& probe) { return probe.proxy().getNumSubscribers() > 0; });
}

void DisplayThread::publishProxies(const DisplayFrame& frame) {
  geometry_msgs::PoseStamped proxy;
  proxy.header.stamp = frame.stamp;
  proxy.header.frame_id = frame_id_;
  for (std::size_t k = 0; k < frame.probes.size(); ++k) {
    const ProbeView& probe = frame.probes[k];
    if (!probe.report.present) continue;
    proxy.pose = toPose(probe.report.proxy, probe.report.orientation);
    sources_.probes[k].proxy().publish(proxy);
  }
}

void DisplayThread::publishDiagnostics(double now) {
  diagnostic_msgs::DiagnosticArray array;
  array.header.stamp = ros::Time::now();
  const SolverStats& solver = shared_.solver_stats.read();
  array.status = {
      solverStatus(solver, shared_.paused, now),
      hapticStatus(shared_.haptic_stats.read(), sources_.haptics.scheduling(), now),
      displayStatus(marker_frames_, state_frames_, sources_.master.reachable(), sources_.master.renewals()),
      optionsStatus(shared_.live_report.read())};
  for (std::size_t k = 0; k < sources_.probes.size(); ++k) {
    const ProbeTopics& probe = sources_.probes[k];
    SharedProbe& shared = shared_.probes[k];
    const double force_error = k < solver.force_errors.size() ? solver.force_errors[k] : 0.0;
    std::string others = sources_.master.otherPublishers(probe.reaction().getTopic());
    if (others.empty()) others = sources_.master.otherPublishers(probe.command().getTopic());
    array.status.push_back(probeStatus(probe.name(), {probe.poses(), probe.forces()}, shared.felt.read(),
                                       shared.session().grasp(), force_error, now, others));
  }
  for (const ObstacleTopics& obstacle : sources_.obstacles) {
    array.status.push_back(obstacleStatus(obstacle.name(), obstacle.counters(), now));
  }
  for (diagnostic_msgs::DiagnosticStatus& status : array.status)
    status.name = sources_.name + ": " + status.name;
  publishers_.diagnostics.publish(array);
}

}  // namespace haptic_cloth
