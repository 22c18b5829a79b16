#include "ros/display/flow_meter.h"

#include <geometry_msgs/PoseStamped.h>
#include <geometry_msgs/WrenchStamped.h>
#include <visualization_msgs/MarkerArray.h>

#include <algorithm>
#include <cmath>
#include <cstdio>

#include "ros/node/conversions.h"
#include "ros/node/steady_clock.h"
#include "ros/node/topics.h"

namespace haptic_cloth {
namespace {

constexpr int kCountQueue = 1000;  ///< long enough that no message is lost while others are handled

/// @param gap between layers [m]; infinite: none are near
std::string gapText(double gap) {
  char text[32] = "none";
  if (std::isfinite(gap)) std::snprintf(text, sizeof text, "%.2f mm", 1e3 * gap);
  return text;
}

bool isFinite(const std::vector<float>& numbers) {
  return std::all_of(numbers.begin(), numbers.end(), [](float number) { return std::isfinite(number); });
}

bool isFinite(const visualization_msgs::MarkerArray& array) {
  return std::all_of(
      array.markers.begin(), array.markers.end(), [](const visualization_msgs::Marker& marker) {
        return std::all_of(marker.points.begin(), marker.points.end(),
                           [](const geometry_msgs::Point& point) { return toVec3(point).allFinite(); });
      });
}

}  // namespace

FlowMeter::FlowMeter(ros::NodeHandle& node, const std::vector<std::string>& probes, double reaction_rate,
                     double display_rate)
    : markers_{"markers", display_rate}, state_{"state", display_rate} {
  for (const std::string& name : probes) {
    probes_.emplace_back();
    probes_.back().reaction = {name + "/reaction", reaction_rate};
    subscribe(node, name, probes_.back());
  }
  markers_subscriber_ = node.subscribe<visualization_msgs::MarkerArray>(
      topics::kMarkers, 2,
      [this](const visualization_msgs::MarkerArray::ConstPtr& message) { markers_.add(isFinite(*message)); });
  state_subscriber_ = node.subscribe<ClothState>(
      topics::kState, 2, [this](const ClothState::ConstPtr& message) { note(*message); });
}

void FlowMeter::note(const ClothState& state) {
  state_.add(isFinite(state.positions) && isFinite(state.tension) && isFinite(state.bending));
  for (Probe& probe : probes_) probe.states_without = std::min(probe.states_without + 1, kAbsent);
  cells_ = state.levels.size();
  rung_ = state.rung;
  worst_rung_ = std::max(worst_rung_, rung_);
  slipped_ = state.slipped;
  pairs_ = state.self_contacts;
  most_pairs_ = std::max(most_pairs_, pairs_);
  gap_ = state.min_self_gap;
  smallest_gap_ = std::min(smallest_gap_, gap_);
  failed_ = state.failed_steps;
  out_of_reach_ = state.out_of_reach;
  const double now = steadyNow();
  if (received_ >= 0.0 && state.time >= time_) {  // else the cloth was reset
    simulated_ += state.time - time_;
    elapsed_ += now - received_;
  }
  time_ = state.time;
  received_ = now;
}

void FlowMeter::subscribe(ros::NodeHandle& node, const std::string& name, Probe& probe) {
  probe.reaction_subscriber = node.subscribe<geometry_msgs::WrenchStamped>(
      topics::ofProbe(name, topics::kReaction), kCountQueue,
      [&probe](const geometry_msgs::WrenchStamped::ConstPtr& message) {
        const auto& wrench = message->wrench;
        const Vec3 force(wrench.force.x, wrench.force.y, wrench.force.z);
        probe.reaction.add(force.allFinite());
        probe.force = force.norm();
        probe.max_force = std::max(probe.max_force, probe.force);
      },
      ros::VoidConstPtr(), ros::TransportHints().tcpNoDelay());
  probe.proxy_subscriber = node.subscribe<geometry_msgs::PoseStamped>(
      topics::ofProbe(name, topics::kProxy), 2,
      [&probe](const geometry_msgs::PoseStamped::ConstPtr& message) {
        probe.height = message->pose.position.z;
        probe.states_without = 0;
      });
}

std::vector<const Flow*> FlowMeter::flows() const {
  std::vector<const Flow*> all;
  for (const Probe& probe : probes_) all.push_back(&probe.reaction);
  all.push_back(&markers_);
  all.push_back(&state_);
  return all;
}

std::string FlowMeter::missing() const {
  std::string names;
  for (const Flow* flow : flows()) {
    if (flow->count == 0) names += (names.empty() ? "" : ", ") + flow->name;
  }
  return names;
}

void FlowMeter::clear() {
  for (Probe& probe : probes_) {
    probe.reaction.count = 0;
    probe.max_force = 0.0;
  }
  markers_.count = state_.count = 0;
  worst_rung_ = rung_;
  most_pairs_ = pairs_;
  smallest_gap_ = gap_;
  simulated_ = elapsed_ = 0.0;
}

std::string FlowMeter::line(double seconds) const {
  std::string text;
  char part[200];
  for (const Probe& probe : probes_) {
    if (probe.reaction.count == 0) {
      text += probe.reaction.name + ": no messages | ";
      continue;
    }
    std::snprintf(part, sizeof part, "%s %6.1f Hz  force %5.2f N (max %5.2f)  ", probe.reaction.name.c_str(),
                  probe.reaction.count / seconds, probe.force, probe.max_force);
    text += part;
    std::snprintf(part, sizeof part, "proxy z %6.1f mm | ", 1e3 * probe.height);
    text += probe.states_without < kAbsent ? part : "proxy absent | ";
  }
  std::snprintf(part, sizeof part, "markers %4.1f Hz  state %4.1f Hz", markers_.count / seconds,
                state_.count / seconds);
  text += part;
  if (state_.count == 0) return text + " | no state of the cloth: does the node run?";
  std::snprintf(part, sizeof part,
                " | cells %5zu  t %6.2f s  speed %4.2f  rung %d  slipped %.2f s | self-contacts %3u  gap %s  "
                "failed %llu",
                cells_, time_, realTimeFactor(), rung_, slipped_, pairs_, gapText(gap_).c_str(),
                static_cast<unsigned long long>(failed_));
  return text + part;
}

std::string FlowMeter::verdict(double seconds, bool& passed) const {
  passed = true;
  std::string text;
  for (const Flow* flow : flows()) {
    const double rate = flow->count / seconds;
    passed = passed && rate >= flow->wanted && flow->finite;
    char part[100];
    std::snprintf(part, sizeof part, ", %s %.1f Hz (at least %.0f)%s", flow->name.c_str(), rate, flow->wanted,
                  flow->finite ? "" : " NOT FINITE");
    text += part;
  }
  double most = 0.0;
  for (const Probe& probe : probes_) most = std::max(most, probe.max_force);
  char rest[200];
  std::snprintf(rest, sizeof rest,
                ", force up to %.2f N, speed %.2f, rung up to %d, slipped %.2f s, self-contacts up to %u, "
                "smallest gap %s, failed %llu (%llu out of reach)",
                most, realTimeFactor(), worst_rung_, slipped_, most_pairs_, gapText(smallest_gap_).c_str(),
                static_cast<unsigned long long>(failed_), static_cast<unsigned long long>(out_of_reach_));
  return (passed ? "PASS: " : "FAIL: ") + text.substr(2) + rest;
}

}  // namespace haptic_cloth
