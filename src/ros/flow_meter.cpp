#include "ros/flow_meter.h"

#include <geometry_msgs/PoseStamped.h>
#include <geometry_msgs/WrenchStamped.h>
#include <haptic_cloth/ClothState.h>
#include <visualization_msgs/MarkerArray.h>

#include <algorithm>
#include <cstdio>

#include "ros/conversions.h"
#include "ros/topics.h"

namespace haptic_cloth {
namespace {

constexpr int kCountQueue = 1000;  ///< long enough that none is lost while the others are looked at

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

FlowMeter::FlowMeter(ros::NodeHandle& node, double reaction_rate, double display_rate)
    : reaction_{"reaction", reaction_rate}, markers_{"markers", display_rate}, state_{"state", display_rate} {
  reaction_subscriber_ = node.subscribe<geometry_msgs::WrenchStamped>(
      topics::kReaction, kCountQueue,
      [this](const geometry_msgs::WrenchStamped::ConstPtr& message) {
        const auto& wrench = message->wrench;
        const Vec3 force(wrench.force.x, wrench.force.y, wrench.force.z);
        reaction_.add(force.allFinite());
        force_ = force.norm();
        max_force_ = std::max(max_force_, force_);
      },
      ros::VoidConstPtr(), ros::TransportHints().tcpNoDelay());
  markers_subscriber_ = node.subscribe<visualization_msgs::MarkerArray>(
      topics::kMarkers, 2,
      [this](const visualization_msgs::MarkerArray::ConstPtr& message) { markers_.add(isFinite(*message)); });
  state_subscriber_ =
      node.subscribe<ClothState>(topics::kState, 2, [this](const ClothState::ConstPtr& message) {
        state_.add(isFinite(message->positions) && isFinite(message->tension) && isFinite(message->bending));
        cells_ = message->levels.size();
        time_ = message->time;
        if (first_time_ < 0.0) first_time_ = time_;
      });
  proxy_subscriber_ = node.subscribe<geometry_msgs::PoseStamped>(
      topics::kProxy, 2,
      [this](const geometry_msgs::PoseStamped::ConstPtr& message) { height_ = message->pose.position.z; });
}

bool FlowMeter::allFlow() const { return reaction_.count > 0 && markers_.count > 0 && state_.count > 0; }

void FlowMeter::clear() {
  reaction_.count = markers_.count = state_.count = 0;
  max_force_ = 0.0;
  first_time_ = -1.0;
}

std::string FlowMeter::line(double seconds) const {
  const double simulated = first_time_ < 0.0 ? 0.0 : time_ - first_time_;
  char text[200];
  std::snprintf(
      text, sizeof text,
      "reaction %6.1f Hz  markers %4.1f Hz  state %4.1f Hz | force %5.2f N (max %5.2f)  proxy z %6.1f mm"
      " | cells %5zu  t %6.2f s  speed %4.2f",
      reaction_.count / seconds, markers_.count / seconds, state_.count / seconds, force_, max_force_,
      1e3 * height_, cells_, time_, simulated / seconds);
  return text;
}

std::string FlowMeter::verdict(double seconds, bool& passed) const {
  passed = true;
  std::string text;
  for (const Flow* flow : {&reaction_, &markers_, &state_}) {
    const double rate = flow->count / seconds;
    passed = passed && rate >= flow->wanted && flow->finite;
    char part[100];
    std::snprintf(part, sizeof part, ", %s %.1f Hz (at least %.0f)%s", flow->name.c_str(), rate, flow->wanted,
                  flow->finite ? "" : " NOT FINITE");
    text += part;
  }
  char force[60];
  std::snprintf(force, sizeof force, ", force up to %.2f N", max_force_);
  return (passed ? "PASS: " : "FAIL: ") + text.substr(2) + force;
}

}  // namespace haptic_cloth
