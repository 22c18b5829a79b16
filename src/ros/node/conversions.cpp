#include "ros/node/conversions.h"

#include <cmath>
#include <cstdio>

#include "haptic_cloth/error.h"
#include "state/number_text.h"

namespace haptic_cloth {
namespace {

using XmlRpc::XmlRpcValue;

/// Quotes text as a double-quoted YAML string, which has the escapes of JSON.
std::string quoted(const std::string& text) {
  std::string out = "\"";
  for (const char c : text) {
    if (c == '"' || c == '\\') {
      out += '\\';
      out += c;
    } else if (static_cast<unsigned char>(c) < 0x20) {
      char escape[8];
      std::snprintf(escape, sizeof escape, "\\x%02x", static_cast<unsigned>(c));
      out += escape;
    } else {
      out += c;
    }
  }
  return out + '"';
}

std::string numberText(double value) {
  if (std::isnan(value)) return ".nan";
  if (std::isinf(value)) return value > 0.0 ? ".inf" : "-.inf";
  return shortestText(value);
}

std::string child(const std::string& key, const std::string& name) {
  return key.empty() ? name : key + "." + name;
}

void appendOverrides(const XmlRpcValue& tree, const std::string& origin, const std::string& key,
                     std::vector<std::string>& overrides) {
  if (tree.getType() != XmlRpcValue::TypeStruct || tree.size() == 0) {
    overrides.push_back(key + "=" + toYaml(tree, origin, key));
    return;
  }
  for (const auto& member : tree) appendOverrides(member.second, origin, child(key, member.first), overrides);
}

}  // namespace

Vec3 toVec3(const geometry_msgs::Point& point) { return {point.x, point.y, point.z}; }

geometry_msgs::Point toPoint(const Vec3& position) {
  geometry_msgs::Point point;
  point.x = position.x();
  point.y = position.y();
  point.z = position.z();
  return point;
}

Quat toQuat(const geometry_msgs::Quaternion& orientation) {
  return {orientation.w, orientation.x, orientation.y, orientation.z};
}

geometry_msgs::Pose toPose(const Vec3& position, const Quat& orientation) {
  geometry_msgs::Pose pose;
  pose.position = toPoint(position);
  pose.orientation.w = orientation.w();
  pose.orientation.x = orientation.x();
  pose.orientation.y = orientation.y();
  pose.orientation.z = orientation.z();
  return pose;
}

bool isFinite(const geometry_msgs::Pose& pose) {
  return toVec3(pose.position).allFinite() && toQuat(pose.orientation).coeffs().allFinite();
}

bool isUnit(const geometry_msgs::Quaternion& orientation) {
  return std::abs(toQuat(orientation).norm() - 1.0) <= 0.1;
}

geometry_msgs::Pose toPose(const Pose& pose) { return toPose(pose.position, pose.orientation); }

Pose toPose(const geometry_msgs::Pose& pose) { return {toVec3(pose.position), toQuat(pose.orientation)}; }

Pose toPose(const geometry_msgs::TransformStamped& transform) {
  const auto& translation = transform.transform.translation;
  return {Vec3(translation.x, translation.y, translation.z),
          toQuat(transform.transform.rotation).normalized()};
}

Pose composed(const Pose& frame, const Pose& pose) {
  return {frame.position + frame.orientation * pose.position, frame.orientation * pose.orientation};
}

geometry_msgs::WrenchStamped toWrench(const Wrench& wrench, const ros::Time& stamp,
                                      const std::string& frame_id) {
  const auto assign = [](const Vec3& from, geometry_msgs::Vector3& to) {
    to.x = from.x();
    to.y = from.y();
    to.z = from.z();
  };
  geometry_msgs::WrenchStamped message;
  message.header.stamp = stamp;
  message.header.frame_id = frame_id;
  assign(wrench.force, message.wrench.force);
  assign(wrench.torque, message.wrench.torque);
  return message;
}

void toClothState(const DisplayFrame& frame, int columns, int rows, std::vector<int>& scratch,
                  ClothState& message) {
  message.time = frame.time;
  message.columns = columns;
  message.rows = rows;
  message.particles.clear();
  message.positions.clear();
  message.corners.clear();
  message.levels.clear();
  scratch.assign(frame.positions.size(), -1);
  for (const CellView& cell : frame.cells) {
    for (const int particle : cell.particles) {
      int& vertex = scratch[particle];
      if (vertex < 0) {
        vertex = static_cast<int>(message.particles.size());
        message.particles.push_back(particle);
        for (int k = 0; k < 3; ++k) {
          message.positions.push_back(static_cast<float>(frame.positions[particle][k]));
        }
      }
      message.corners.push_back(vertex);
    }
    message.levels.push_back(static_cast<std::uint8_t>(cell.level));
  }
  message.tension = frame.tension;
  message.bending = frame.bending;
  message.rung = static_cast<std::uint8_t>(frame.quality.rung);
  message.given_up = frame.quality.given_up;
  message.step_length = frame.quality.step_length;
  message.slipped = frame.quality.slipped;
  message.self_contacts = static_cast<std::uint32_t>(frame.last.self_contacts);
  message.min_self_gap = frame.last.min_self_gap;
  message.failed_steps = frame.failed.count;
  message.out_of_reach = frame.failed.out_of_reach;
  message.force_errors.clear();
  for (const ProbeView& probe : frame.probes) {
    message.force_errors.push_back(static_cast<float>(probe.force_error));
  }
}

std::optional<double> toNumber(const XmlRpcValue& value) {
  XmlRpcValue copy = value;
  if (value.getType() == XmlRpcValue::TypeInt) return static_cast<int>(copy);
  if (value.getType() == XmlRpcValue::TypeDouble) return static_cast<double>(copy);
  if (value.getType() != XmlRpcValue::TypeString) return std::nullopt;
  return readNumber(static_cast<std::string>(copy));
}

std::string toYaml(const XmlRpcValue& value, const std::string& origin, const std::string& key) {
  // XmlRpcValue's conversions are not const; copies of scalars are cheap.
  XmlRpcValue copy = value;
  switch (value.getType()) {
    case XmlRpcValue::TypeBoolean:
      return static_cast<bool>(copy) ? "true" : "false";
    case XmlRpcValue::TypeInt:
      return std::to_string(static_cast<int>(copy));
    case XmlRpcValue::TypeDouble:
      return numberText(static_cast<double>(copy));
    case XmlRpcValue::TypeString: {
      const std::string text = static_cast<std::string>(copy);
      return readNumber(text) ? text : quoted(text);
    }
    case XmlRpcValue::TypeArray: {
      std::string out = "[";
      for (int i = 0; i < value.size(); ++i) {
        out += (i ? ", " : "") + toYaml(value[i], origin, key + "[" + std::to_string(i) + "]");
      }
      return out + "]";
    }
    case XmlRpcValue::TypeStruct: {
      std::string out = "{";
      for (const auto& member : value) {
        if (out.size() > 1) out += ", ";
        out += quoted(member.first) + ": " + toYaml(member.second, origin, child(key, member.first));
      }
      return out + "}";
    }
    default:
      throw InputError(origin, key, "", "must be a number, text, list or map");
  }
}

std::vector<std::string> toOverrides(const XmlRpcValue& tree, const std::string& origin) {
  std::vector<std::string> overrides;
  if (tree.getType() == XmlRpcValue::TypeStruct && tree.size() > 0) {
    appendOverrides(tree, origin, "", overrides);
  }
  return overrides;
}

}  // namespace haptic_cloth
