#include "ros/options/node_table.h"

#include <algorithm>

#include "haptics/haptic_options.h"

namespace haptic_cloth {
namespace {

/// A higher rate would keep a core busy without a visible gain.
constexpr Range kDisplayRate{0.0, 1000.0, true};

Options generalOptions(NodeOptions& node) {
  Options options{
      {"frame_id", field(node.frame_id), kNoRange, "", "frame of the cloth and of all output; not empty"},
      {"scene_file", field(node.scene_file), kNoRange, "", "read first; scene parameters override it"},
      {"scene_directory", field(node.scene_directory), kNoRange, "",
       "without `scene_file`: folder of relative fabric paths"},
      {"max_pose_age", field(node.max_pose_age), kNotNegative, "s",
       "a pose with an older stamp is dropped; 0: never", Live{0.0, 2.0}},
      {"step_budget", field(node.step_budget), kNotNegative, "s",
       "wall clock of one step, whatever the scene; 0: no limit", Live{0.0, 0.1}},
      {"keep_clock", field(node.pace.keep_clock), kNoRange, "",
       "a late solver gives up quality instead of simulated time", Live{0.0, 1.0}},
      {"max_time_step", field(node.pace.max_time_step), kPositive, "s", "longest step of a late solver",
       Live{0.001, 0.02}},
      {"record", field(node.record), kNoRange, "",
       "file for a recording that `simulate` replays; empty: none"},
      {"gain_ramp", field(node.gain_ramp), kNotNegative, "s", "time in which changed gains are reached",
       Live{0.0, 5.0}},
      {"devices", OwnReader{"{}", "map"}, kNoRange, "", "other values of `device` for a probe, by its name"}};
  for (const Option& option : poseOptions(node.haptics)) options.push_back(option);
  return options;
}

Options markerOptions(MarkerOptions& markers) {
  return {{"rate", field(markers.rate), kDisplayRate, "Hz", "rate of `cloth/markers`", Live{1.0, 60.0}},
          {"force_scale", field(markers.force_scale), kPositive, "m/N", "length of the force arrow",
           Live{0.001, 0.5}},
          {"colouring", field(markers.colouring, colouringNames()), kNoRange, "",
           "what the lines of the mesh show", Live{}},
          {"full_tension", field(markers.full_tension), kPositive, "N/m",
           "tension at which a line has its full colour", Live{0.1, 500.0}},
          {"full_bending", field(markers.full_bending), kPositive, "J/m²",
           "bending energy at which a line has its full colour", Live{1e-4, 1.0}}};
}

/// Number of groups around a path: 2 for "haptics/passivity/".
std::size_t depthOf(const std::string& path) {
  return static_cast<std::size_t>(std::count(path.begin(), path.end(), '/'));
}

/// Line of YAML with a comment.
std::string yamlLine(std::size_t depth, const std::string& text, const std::string& comment) {
  constexpr std::size_t kColumn = 36;  ///< of the comments
  std::string line = std::string(2 * depth, ' ') + text + ' ';
  line.resize(std::max(line.size(), kColumn), ' ');
  return line + "# " + comment + '\n';
}

}  // namespace

std::vector<OptionGroup> groupsOf(NodeOptions& node) {
  std::vector<OptionGroup> groups{
      {"", "", generalOptions(node)},
      {kDevicePath, "how the device maps to the cloth; docs/guide/devices.md", optionsOf(node.device)}};
  for (const OptionGroup& group : groupsOf(node.haptics)) groups.push_back(group);
  groups.push_back({"markers/", "what rviz draws", markerOptions(node.markers)});
  groups.push_back({"state/",
                    "cloth/state and NAME/proxy",
                    {{"rate", field(node.state_rate), kDisplayRate, "Hz",
                      "rate of `cloth/state` and `NAME/proxy`", Live{1.0, 60.0}}}});
  return groups;
}

std::string defaultParameters() {
  NodeOptions node;
  std::string text =
      "# Parameters of the node, with the defaults of the code (a test compares them). Keys of a scene may\n"
      "# stand beside them. Any other key is an error.\n";
  for (const OptionGroup& group : groupsOf(node)) {
    const std::size_t depth = depthOf(group.path);
    if (depth > 0) {
      const std::string name = group.path.substr(0, group.path.size() - 1);
      text += yamlLine(depth - 1, name.substr(name.rfind('/') + 1) + ':', group.meaning);
    }
    for (const Option& option : group.options) {
      text += yamlLine(depth, option.key + ": " + valueText(option), describe(option));
    }
  }
  return text;
}

std::vector<std::pair<std::string, std::string>> nodeTables() {
  NodeOptions node;
  std::vector<std::pair<std::string, std::string>> tables;
  for (const OptionGroup& group : groupsOf(node)) {
    tables.emplace_back(group.path.empty() ? "general" : group.path.substr(0, group.path.size() - 1),
                        markdownTable(group));
  }
  return tables;
}

}  // namespace haptic_cloth
