/// Shipped files as the parameter server holds them.
#pragma once

#include <xmlrpcpp/XmlRpcValue.h>
#include <yaml-cpp/yaml.h>

#include <string>

namespace haptic_cloth {

/// A YAML node as rosparam puts it on the parameter server.
inline XmlRpc::XmlRpcValue toParameter(const YAML::Node& node) {
  XmlRpc::XmlRpcValue value;
  if (node.IsMap()) {
    value.begin();
    for (const auto& member : node) value[member.first.as<std::string>()] = toParameter(member.second);
  } else if (node.IsSequence()) {
    value.setSize(static_cast<int>(node.size()));
    for (std::size_t i = 0; i < node.size(); ++i) value[static_cast<int>(i)] = toParameter(node[i]);
  } else {
    int whole;
    double number;
    const std::string text = node.as<std::string>();
    if (node.Tag() != "!" && YAML::convert<int>::decode(node, whole)) {
      value = whole;
    } else if (node.Tag() != "!" && YAML::convert<double>::decode(node, number)) {
      value = number;
    } else if (node.Tag() != "!" && (text == "true" || text == "false")) {
      value = text == "true";
    } else {
      value = text;
    }
  }
  return value;
}

inline XmlRpc::XmlRpcValue sceneParameters() {
  return toParameter(YAML::LoadFile(std::string(HAPTIC_CLOTH_SOURCE_DIR) + "/test/ros/scene.yaml"));
}

}  // namespace haptic_cloth
