#include "ros/display_thread.h"

#include <diagnostic_msgs/DiagnosticArray.h>

#include <algorithm>

#include "ros/conversions.h"
#include "ros/diagnostics.h"
#include "ros/steady_clock.h"

namespace haptic_cloth {
namespace {

constexpr double kDiagnosticsPeriod = 1.0;  ///< [s]

/// Whether something that comes every `period` is due; moves `due` on without piling up what was missed.
bool isDue(double now, double period, double& due) {
  if (now < due) return false;
  due = std::max(due + period, now);
  return true;
}

}  // namespace

DisplayThread::DisplayThread(const NodeOptions& options, const DisplayPublishers& publishers,
                             const DeviceInput& input, const HapticThread& haptics, const MasterWatch& master,
                             SharedState& shared)
    : frame_id_(options.frame_id),
      columns_(options.scene.cloth.particles[0]),
      rows_(options.scene.cloth.particles[1]),
      markers_period_(1.0 / options.markers_rate),
      state_period_(1.0 / options.state_rate),
      haptic_rate_(options.haptics.rate),
      publishers_(publishers),
      input_(input),
      haptics_(haptics),
      master_(master),
      shared_(shared),
      builder_(options.scene, options.frame_id, options.markers_force_scale) {}

void DisplayThread::run() {
  const double start = steadyNow();
  double markers_due = start, state_due = start, diagnostics_due = start + kDiagnosticsPeriod;
  while (!shared_.stop) {
    sleepUntil(std::min({markers_due, state_due, diagnostics_due}));
    const double now = steadyNow();
    const bool markers =
        isDue(now, markers_period_, markers_due) && publishers_.markers.getNumSubscribers() > 0;
    const bool state = isDue(now, state_period_, state_due);
    const bool mesh = state && publishers_.state.getNumSubscribers() > 0;
    const bool proxy = state && publishers_.proxy.getNumSubscribers() > 0;
    if (markers || mesh || proxy) {
      // The copy that answers this wish is shown next time: at most one frame old, and nobody waits.
      const DisplayFrame& frame = shared_.frame.read();
      shared_.frame_wanted = true;
      if (frame.valid && markers) publishMarkers(frame);
      if (frame.valid && mesh) publishState(frame);
      if (frame.valid && proxy) publishProxy(frame);
    }
    if (isDue(now, kDiagnosticsPeriod, diagnostics_due)) publishDiagnostics(now);
  }
}

void DisplayThread::publishMarkers(const DisplayFrame& frame) {
  publishers_.markers.publish(builder_.build(frame, shared_.force.read(), ros::Time::now()));
  ++marker_frames_;
}

void DisplayThread::publishState(const DisplayFrame& frame) {
  toClothState(frame, columns_, rows_, scratch_, state_);
  state_.header.stamp = ros::Time::now();
  state_.header.frame_id = frame_id_;
  publishers_.state.publish(state_);
  ++state_frames_;
}

void DisplayThread::publishProxy(const DisplayFrame& frame) {
  if (!frame.probe.present) return;
  geometry_msgs::PoseStamped proxy;
  proxy.header.stamp = ros::Time::now();
  proxy.header.frame_id = frame_id_;
  proxy.pose = toPose(frame.probe.proxy);
  publishers_.proxy.publish(proxy);
}

void DisplayThread::publishDiagnostics(double now) {
  diagnostic_msgs::DiagnosticArray array;
  array.header.stamp = ros::Time::now();
  array.status = {solverStatus(shared_.solver_stats.read(), shared_.paused, now),
                  hapticStatus(shared_.haptic_stats.read(), haptic_rate_, haptics_.scheduling(), now),
                  inputStatus(input_.counters()),
                  displayStatus(marker_frames_, state_frames_, master_.reachable(), master_.renewals())};
  publishers_.diagnostics.publish(array);
}

}  // namespace haptic_cloth
