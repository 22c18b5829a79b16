/// Shipped files as the parameter server holds them, and messages of the node about parameters.
#pragma once

#include <xmlrpcpp/XmlRpcValue.h>
#include <yaml-cpp/yaml.h>

#include <string>

#include "haptic_cloth/error.h"
#include "ros/options/node_options.h"

namespace haptic_cloth {

/// Converts a YAML node as rosparam does for the parameter server.
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
  return toParameter(YAML::LoadFile(std::string(HAPTIC_CLOTH_SOURCE_DIR) + "/test/ros/support/scene.yaml"));
}

/// Parameters of a scene with those of config/node.yaml.
inline XmlRpc::XmlRpcValue withSettings(const YAML::Node& settings) {
  XmlRpc::XmlRpcValue parameters = sceneParameters();
  for (const auto& entry : toParameter(settings)) parameters[entry.first] = entry.second;
  return parameters;
}

/// @return the error message; empty if the parameters are accepted
inline std::string messageOf(const XmlRpc::XmlRpcValue& parameters) {
  try {
    parseNodeOptions(parameters, "/cloth (parameters)");
  } catch (const InputError& error) {
    return error.what();
  }
  return "";
}

}  // namespace haptic_cloth
