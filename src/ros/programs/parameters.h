/// Parameters that the programs beside the node read.
#pragma once

#include <ros/node_handle.h>

#include <string>

#include "ros/options/node_options.h"
#include "ros/options/parameter_group.h"

namespace haptic_cloth {

/// The program's own parameters.
inline ParameterGroup ownParameters(const ros::NodeHandle& private_node) {
  XmlRpc::XmlRpcValue tree;
  private_node.getParam(private_node.getNamespace(), tree);
  return ParameterGroup(tree, private_node.getNamespace() + " (parameters)");
}

/// Options of the node whose resolved name is `node_name`.
/// @throws InputError as parseNodeOptions()
inline NodeOptions optionsOf(const ros::NodeHandle& node, const std::string& node_name) {
  XmlRpc::XmlRpcValue tree;
  node.getParam(node_name, tree);
  return parseNodeOptions(tree, node_name + " (parameters)");
}

}  // namespace haptic_cloth
