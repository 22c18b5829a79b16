#include "ros/programs/program_options.h"

#include "ros/input/device_adapter.h"

namespace haptic_cloth {
namespace {

constexpr char kServed[] = "node whose parameters name the probes";

/// Rows of one program as one table.
template <class ProgramOptions>
std::string tableOf(ProgramOptions options) {
  OptionGroup all;
  for (const OptionGroup& group : groupsOf(options)) {
    for (Option option : group.options) {
      option.key = group.path + option.key;
      all.options.push_back(option);
    }
  }
  return markdownTable(all);
}

}  // namespace

std::vector<OptionGroup> groupsOf(HandOptions& hand) {
  return {
      {"",
       "",
       {{"start", field(hand.start), kPosition, "m", "waiting position above the cloth"},
        {"press", field(hand.press), kPosition, "m", "target of the pressing hand"},
        {"slide", field(hand.slide), kPosition, "m", "displacement while it presses"},
        {"delay", field(hand.delay), kNotNegative, "s", "before the first approach"},
        {"approach_time", field(hand.approach_time), kPositive, "s", "down to `press`"},
        {"hold_time", field(hand.hold_time), kNotNegative, "s", "rest at both ends of the slide, and above"},
        {"slide_time", field(hand.slide_time), kPositive, "s", "duration of the slide"},
        {"lift_time", field(hand.lift_time), kPositive, "s", "back to `start`"},
        {"mass", field(hand.mass), kPositive, "kg", "mass of device and finger"},
        {"stiffness", field(hand.stiffness), kPositive, "N/m", "stiffness of the arm"},
        {"damping", field(hand.damping), kNotNegative, "N·s/m", "damping of the arm"},
        {"rate", field(hand.rate), atLeast(1), "Hz", "poses per second"},
        {"frame_id", field(hand.frame_id), kNoRange, "", "frame of the poses"}}}};
}

std::vector<OptionGroup> groupsOf(MouseHandOptions& hand) {
  return {{"",
           "",
           {{"node", field(hand.node), kNoRange, "", kServed},
            {"rate", field(hand.rate), atLeast(1), "Hz", "poses per second"},
            {"time_constant", field(hand.time_constant), kPositive, "s", "lag between marker and hand"}}}};
}

std::vector<OptionGroup> groupsOf(PathHandOptions& hand) {
  return {{"",
           "",
           {{"node", field(hand.node), kNoRange, "", kServed},
            {"rate", field(hand.rate), atLeast(1), "Hz", "poses per second"},
            {"repeat_after", field(hand.repeat_after), kNotNegative, "s",
             "wait after the end of all paths before they start again with a reset; 0: they do not"}}}};
}

std::vector<OptionGroup> groupsOf(MonitorOptions& monitor) {
  return {{"",
           "",
           {{"node", field(monitor.node), kNoRange, "", kServed},
            {"seconds", field(monitor.seconds), kNotNegative, "s",
             "length of the measurement once all topics flow; 0: until interrupted"},
            {"patience", field(monitor.patience), kPositive, "s",
             "longest wait for parameters, then for the first messages"},
            {"reaction_rate", field(monitor.reaction_rate), kNotNegative, "Hz",
             "lowest good rate of `NAME/reaction`"},
            {"display_rate", field(monitor.display_rate), kNotNegative, "Hz",
             "lowest good rate of markers and state"}}}};
}

std::vector<OptionGroup> groupsOf(GraspButtonOptions& button) {
  return {
      {"", "", {{"number", field(button.number), atLeast(0), "", "which of the driver's buttons, from 0"}}}};
}

std::vector<OptionGroup> groupsOf(LatencyProbeOptions& probe) {
  return {
      {"",
       "",
       {{"node", field(probe.node), kNoRange, "", "node that is measured"},
        {"out", field(probe.out), kNoRange, "", "JSON file of the result; empty: standard output"},
        {"nodelet", field(probe.nodelet), kNoRange, "", "loads the node into this process as a nodelet"},
        {"hang", field(probe.hang), kNotNegative, "s", "simulated time before the probe follows its path"},
        {"seconds", field(probe.seconds), atLeast(1), "s", "length of the measurement"}}}};
}

std::vector<std::pair<std::string, std::string>> programTables() {
  return {{"hand", tableOf(HandOptions())},
          {"mouse_hand", tableOf(MouseHandOptions())},
          {"path_hand", tableOf(PathHandOptions())},
          {"monitor", tableOf(MonitorOptions())},
          {"device_adapter", tableOf(AdapterOptions())},
          {"grasp_button", tableOf(GraspButtonOptions())},
          {"latency_probe", tableOf(LatencyProbeOptions())}};
}

}  // namespace haptic_cloth
