/// Parameters that the programs beside the node read.
#pragma once

#include <ros/node_handle.h>

#include <string>

#include "haptic_cloth/error.h"
#include "ros/options/node_options.h"
#include "ros/options/parameter_group.h"
#include "ros/programs/program_options.h"

namespace haptic_cloth {

/// The program's own parameters.
/// @throws InputError for an unknown or removed key, a wrong type or an invalid value
template <class ProgramOptions>
ProgramOptions readProgramOptions(const XmlRpc::XmlRpcValue& parameters, const std::string& origin) {
  ProgramOptions options;
  ParameterGroup root(parameters, origin);
  root.read(groupsOf(options));
  root.rejectRest();
  return options;
}

template <class ProgramOptions>
ProgramOptions ownOptions(const ros::NodeHandle& private_node) {
  XmlRpc::XmlRpcValue tree;
  private_node.getParam(private_node.getNamespace(), tree);
  return readProgramOptions<ProgramOptions>(tree, private_node.getNamespace() + " (parameters)");
}

/// Options of the node whose resolved name is `node_name`.
/// @throws InputError if it has no parameters, or as parseNodeOptions()
inline NodeOptions optionsOf(const ros::NodeHandle& node, const std::string& node_name) {
  XmlRpc::XmlRpcValue tree;
  if (!node.getParam(node_name, tree)) throw InputError(node_name, "", "", "no parameters; is `node` right?");
  return parseNodeOptions(tree, node_name + " (parameters)");
}

}  // namespace haptic_cloth
