/// Rows of the node's parameters beside those of the scene, and the pages that are made of them.
#pragma once

#include <string>
#include <utility>
#include <vector>

#include "ros/options/node_options.h"
#include "scene/option.h"

namespace haptic_cloth {

inline Names<MeshColouring> colouringNames() {
  return {{"level", MeshColouring::Level},
          {"tension", MeshColouring::Tension},
          {"bending", MeshColouring::Bending}};
}

/// Path of the group that each probe has again, below "devices/NAME/".
constexpr char kDevicePath[] = "device/";

/// All groups; the first is that outside of groups. `markers/` stands for "~markers/".
std::vector<OptionGroup> groupsOf(NodeOptions& node);

/// Text of config/node.yaml: all parameters with their defaults.
std::string defaultParameters();

/// Tables of the reference, with their titles.
std::vector<std::pair<std::string, std::string>> nodeTables();

}  // namespace haptic_cloth
