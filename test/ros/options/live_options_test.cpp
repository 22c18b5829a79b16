/// Options that change live, their rules, and how the tools see them. Criteria: for every option, a
/// value set live has the same effect as the private parameter at start; a value that a file may
/// not have is refused live with the same words; a set is accepted as a whole.
#include "ros/options/live_options.h"

#include <gtest/gtest.h>
#include <tf2_ros/buffer.h>

#include <cmath>
#include <limits>
#include <set>
#include <sstream>

#include "haptic_cloth/error.h"
#include "ros/display/diagnostics.h"
#include "ros/display/markers.h"
#include "ros/input/force_input.h"
#include "ros/options/reconfigure_messages.h"
#include "ros/support/yaml_parameters.h"

namespace haptic_cloth::live_options_test {
namespace {

using XmlRpc::XmlRpcValue;

/// Two probes; the index has its own coupling stiffness and force scale.
XmlRpcValue twoProbes() {
  XmlRpcValue parameters = sceneParameters();
  parameters["probes"] = toParameter(YAML::Load("{thumb: {}, index: {coupling_stiffness: 150}}"));
  parameters["devices"] = toParameter(YAML::Load("{index: {force_scale: 0.5}}"));
  return parameters;
}

/// Another value that every rule allows.
LiveValue another(const LiveOption& option, const NodeOptions& options) {
  const LiveValue value = liveValues(options).at(option.name);
  if (const bool* flag = std::get_if<bool>(&value)) return !*flag;
  if (const int* whole = std::get_if<int>(&value)) return *whole + 1;
  if (const double* number = std::get_if<double>(&value)) return *number > 0.0 ? 1.25 * *number : 0.01;
  return option.choices.back();
}

XmlRpcValue toParameter(const LiveValue& value) {
  XmlRpcValue parameter;
  std::visit([&parameter](const auto& v) { parameter = v; }, value);
  return parameter;
}

/// Sets a parameter by its path.
void setParameter(XmlRpcValue& tree, const std::string& path, const XmlRpcValue& value) {
  const std::size_t slash = path.find('/');
  if (slash == std::string::npos) {
    tree[path] = value;
  } else {
    setParameter(tree[path.substr(0, slash)], path.substr(slash + 1), value);
  }
}

/// Text of all live options and of what the threads derive from them.
std::string textOf(const NodeOptions& options) {
  std::ostringstream text;
  text.precision(17);
  for (const auto& [name, value] : liveValues(options)) {
    text << name << ' ';
    std::visit([&text](const auto& v) { text << v << '\n'; }, value);
  }
  text << options.scene.solver.minimizer.time_budget << '\n';
  for (const ProbeSettings& probe : options.probes) {
    text << probe.haptics.rate << ' ' << probe.haptics.max_force << ' ' << probe.haptics.max_torque << ' '
         << probe.haptics.passivity.store << ' ' << probe.haptics.coupling_stiffness << ' '
         << probe.haptics.coupling_damping << ' ' << probe.device.force_scale << '\n';
  }
  return text.str();
}

TEST(LiveOptions, EveryOneIsWhatItsParameterGivesFromTheStart) {
  for (const XmlRpcValue& parameters : {sceneParameters(), twoProbes()}) {
    const NodeOptions options = parseNodeOptions(parameters, "test");
    std::set<std::string> names;
    for (const LiveOption& option : offeredOptions(options)) {
      SCOPED_TRACE(option.name);
      EXPECT_TRUE(names.insert(option.name).second) << "offered twice";
      const LiveValue value = another(option, options);
      const NodeOptions live = changed(options, {{option.name, value}}, "test");
      EXPECT_EQ(liveValues(live).at(option.name), value);
      EXPECT_NE(textOf(live), textOf(options));
      XmlRpcValue restarted = parameters;
      setParameter(restarted, option.name, toParameter(value));
      EXPECT_EQ(textOf(live), textOf(parseNodeOptions(restarted, "test")));
    }
  }
}

TEST(LiveOptions, WhatCannotChangeIsNotOffered) {
  const NodeOptions options = parseNodeOptions(twoProbes(), "test");
  std::set<std::string> names;
  for (const LiveOption& option : offeredOptions(options)) names.insert(option.name);
  for (const char* name : {"probes/thumb/coupling_stiffness", "probes/index/coupling_damping",
                           "devices/index/force_scale", "haptics/rate", "markers/colouring"}) {
    EXPECT_EQ(names.count(name), 1u) << name;
  }
  for (const char* name : {"cloth/particles", "cloth/fabric", "adapt/levels", "adapt/strategy", "obstacles",
                           "scene_file", "frame_id", "solver/time_step", "solver/cost"}) {
    EXPECT_EQ(names.count(name), 0u) << name;
  }
}

std::string refusal(const NodeOptions& options, const LiveValues& values) {
  try {
    changed(options, values, "/cloth (live)");
  } catch (const InputError& error) {
    return error.what();
  }
  return "";
}

TEST(LiveOptions, ImpossibleOnesAreRefusedByNameValueAndRule) {
  const NodeOptions options = parseNodeOptions(sceneParameters(), "test");
  const auto expect = [&](const LiveValues& values, const std::string& message) {
    EXPECT_EQ(refusal(options, values), "/cloth (live): " + message);
  };
  const double nan = std::numeric_limits<double>::quiet_NaN(),
               infinity = std::numeric_limits<double>::infinity();
  expect({{"air_damping", -1.0}}, "air_damping = -1: must be >= 0");
  expect({{"solver/tolerance", nan}}, "solver.tolerance = nan: must be >= 0");
  expect({{"solver/max_iterations", 0}}, "solver.max_iterations = 0: must be >= 1");
  expect({{"solver/max_iterations", 2.5}}, "solver/max_iterations = 2.5: must be a whole number");
  expect({{"solver/time_budget", infinity}}, "solver.time_budget = inf: must be at most 1e12");
  expect({{"probe/coupling_stiffness", 0.0}}, "probe.coupling_stiffness = 0: must be > 0");
  expect({{"devices/probe/force_scale", 0}}, "devices/probe/force_scale = 0: must be in 1e-6 to 100000");
  expect({{"devices/probe/force_scale", std::string("x")}},
         "devices/probe/force_scale = x: must be a number");
  expect({{"haptics/max_force", infinity}}, "haptics/max_force = inf: must be within 1e-12 to 1e12");
  expect({{"haptics/max_torque", -1.0}}, "haptics/max_torque = -1: must be >= 0");
  expect({{"haptics/max_torque", nan}}, "haptics/max_torque = nan: must be >= 0");
  expect({{"haptics/rate", 1e6}}, "haptics/rate = 1e+06: must be in 1 to 10000");
  expect({{"markers/rate", 1e9}}, "markers/rate = 1e+09: must be at most 1000");
  expect({{"markers/colouring", std::string("blue")}},
         "markers/colouring = blue: must be one of level, tension, bending");
  expect({{"markers/colouring", 2}}, "markers/colouring = 2: must be text");
  expect({{"cloth/particles", 33}}, "cloth/particles = 33: cannot change while the node runs");
  for (const char* name :
       {"adapt/levels", "frame_id", "device/offset", "probe/radius", "gravity", "stop/time"})
    expect({{name, 1}}, std::string(name) + " = 1: cannot change while the node runs");
  for (const char* name : {"nix", "solver/nix", "probes/left/radius", "devices/left/offset"})
    expect({{name, 1}}, std::string(name) + " = 1: unknown parameter");
}

TEST(LiveOptions, ABudgetDuringARecordingIsRefusedByItsOwnName) {
  NodeOptions options = parseNodeOptions(sceneParameters(), "test");
  options.step_budget = 0.0;
  options.record = "/tmp/session";
  const std::string rule = ": must be 0 with record = /tmp/session: a recording repeats no clock";
  for (const char* name : {"step_budget", "solver/time_budget"})
    EXPECT_EQ(refusal(options, {{name, 0.02}}), "/cloth (live): " + std::string(name) + " = 0.02" + rule);
  EXPECT_EQ(refusal(options, {{"air_damping", 3.0}}), "");
}

TEST(LiveOptions, ASetIsJudgedAsAWhole) {
  const NodeOptions options = parseNodeOptions(sceneParameters(), "test");
  // Each change alone would leave coarsen_below above refine_above.
  const LiveValues lower{{"adapt/refine_above", 0.2}, {"adapt/coarsen_below", 0.1}};
  EXPECT_EQ(refusal(options, lower), "");
  EXPECT_NE(refusal(options, {{"adapt/refine_above", 0.2}})
                .find("adapt.coarsen_below = 0.35: must be below adapt.refine_above = 0.2"),
            std::string::npos);
  const LiveValues partly{{"air_damping", 3.0}, {"adapt/refine_above", 0.2}};
  EXPECT_NE(refusal(options, partly), "") << "not even what would be good by itself";
  EXPECT_EQ(changed(options, lower, "test").scene.adapt.coarsen_below, 0.1);
  EXPECT_EQ(textOf(changed(options, {}, "test")), textOf(options));
}

TEST(LiveOptions, OnlyGainsThatChangeMoveAndOthersGoOn) {
  const NodeOptions options = parseNodeOptions(twoProbes(), "test");
  const int thumb = options.scene.probes[0].name == "thumb" ? 0 : 1, index = 1 - thumb;
  const LiveOptions first = firstOptions(options);
  EXPECT_EQ(first.number, 0u);
  EXPECT_EQ(first.gains[index].at(0.0).force_scale, 0.5);
  const NodeOptions stiffer =
      changed(options, {{"probes/thumb/coupling_stiffness", 800}, {"gain_ramp", 2.0}}, "test");
  const LiveOptions second = nextOptions(first, stiffer, 10.0);
  EXPECT_EQ(second.number, 1u);
  EXPECT_EQ(second.gains[thumb].at(11.0).coupling_stiffness, 600.0) << "half way from 400 after 1 of 2 s";
  EXPECT_EQ(second.gains[index].at(11.0).coupling_stiffness, 150.0);
  const NodeOptions other = changed(*second.options, {{"haptics/max_force", 1.0}}, "test");
  const LiveOptions third = nextOptions(second, other, 11.0);
  EXPECT_EQ(third.gains[thumb].at(11.5).coupling_stiffness, 700.0);
  EXPECT_EQ(third.gains[thumb].at(12.0).coupling_stiffness, 800.0);
}

TEST(ReconfigureMessages, SayAllThereIs) {
  const NodeOptions options = parseNodeOptions(twoProbes(), "test");
  const std::vector<LiveOption> offered = offeredOptions(options);
  const dynamic_reconfigure::Config config = toConfig(offered, options);
  const dynamic_reconfigure::ConfigDescription description = toDescription(offered, options);
  const LiveValues values = toValues(config), low = toValues(description.min),
                   high = toValues(description.max), start = toValues(description.dflt);
  EXPECT_EQ(values.size(), offered.size());
  EXPECT_EQ(start, values);
  std::map<std::string, std::string> types;
  for (const auto& group : description.groups) {
    for (const auto& parameter : group.parameters) {
      EXPECT_TRUE(types.emplace(parameter.name, parameter.type).second);
      EXPECT_EQ(parameter.edit_method.empty(), parameter.type != "str");
      EXPECT_FALSE(parameter.description.empty());
    }
  }
  ASSERT_EQ(description.groups.size(), config.groups.size());
  EXPECT_EQ(description.groups[0].name, "Default");
  for (const LiveOption& option : offered) {
    SCOPED_TRACE(option.name);
    const LiveValue value = values.at(option.name);
    EXPECT_EQ(value, liveValues(options).at(option.name));
    const char* const type[] = {"bool", "int", "double", "str"};
    EXPECT_EQ(types.at(option.name), type[value.index()]);
    ASSERT_EQ(low.at(option.name).index(), value.index());
    ASSERT_EQ(high.at(option.name).index(), value.index());
    EXPECT_LE(low.at(option.name), value) << "the slider does not reach the default";
    if (types.at(option.name) != "str") {
      EXPECT_GE(high.at(option.name), value);
      for (const LiveValue& end : {low.at(option.name), high.at(option.name)}) {
        // One threshold alone at its end may contradict another.
        if (option.name.find("adapt/") == 0) continue;
        EXPECT_EQ(refusal(options, {{option.name, end}}), "");
      }
    }
  }
}

TEST(ReconfigureMessages, AWrongTypeIsRefusedNotGuessed) {
  const NodeOptions options = parseNodeOptions(sceneParameters(), "test");
  dynamic_reconfigure::Config config;
  config.bools.resize(1);
  config.bools[0].name = "haptics/max_force";
  config.bools[0].value = true;
  EXPECT_EQ(refusal(options, toValues(config)), "/cloth (live): haptics/max_force = true: must be a number");
}

TEST(LiveMarkers, LinesAreColouredByWhatIsAskedFor) {
  const NodeOptions node = parseNodeOptions(sceneParameters(), "test");
  DisplayFrame frame;
  for (int p = 0; p < 17 * 17; ++p) frame.positions.push_back(Vec3(0.01 * (p % 17), 0.01 * (p / 17), 0.0));
  frame.cells = {{{0, 16, 16 * 17, 17 * 17 - 1}, 4, false}};
  frame.tension = frame.bending = {0.0F};
  frame.probes.resize(1);
  MarkerOptions options;
  options.full_tension = 2.0;
  MarkerBuilder builder(node.scene, "world", options);
  const auto green = [&] {
    return builder.build(frame, {Vec3::Zero()}, ros::Time(1.0)).markers[1].colors[0].g;
  };
  const float level = green();
  frame.tension = {1.0F};
  EXPECT_EQ(green(), level) << "level by default";
  options.colouring = MeshColouring::Tension;
  builder.setOptions(options);
  EXPECT_NEAR(green(), 0.95 - 0.85 * 0.5, 1e-6) << "half of full_tension is half way from white to red";
  frame.tension = {50.0F};
  EXPECT_NEAR(green(), 0.95 - 0.85, 1e-6);
  options.colouring = MeshColouring::Bending;
  builder.setOptions(options);
  EXPECT_NEAR(green(), 0.95, 1e-6);
}

TEST(LiveDiagnostics, ARefusalIsSeen) {
  using diagnostic_msgs::DiagnosticStatus;
  LiveReport report;
  EXPECT_EQ(optionsStatus(report).level, DiagnosticStatus::OK);
  report.refused_last = true;
  report.refusal = "why not";
  EXPECT_EQ(optionsStatus(report).level, DiagnosticStatus::WARN);
  EXPECT_NE(optionsStatus(report).message.find("why not"), std::string::npos);
}

TEST(LiveOptions, ForcesAreHeldToTheAgeThatPosesAre) {
  ros::Time::init();
  XmlRpcValue parameters = sceneParameters();
  parameters["device"]["kind"] = "admittance";
  parameters["max_pose_age"] = 0.0;  // no pose is too old
  const NodeOptions options = parseNodeOptions(parameters, "test");
  SharedState shared(options);
  const tf2_ros::Buffer transforms;
  ForceInput input(options, 0, transforms, shared);
  geometry_msgs::WrenchStamped wrench;
  wrench.header.stamp = ros::Time::now() - ros::Duration(5.0);
  input.accept(wrench, "/device");
  EXPECT_EQ(input.counters().dropped(), 0u);
  NodeOptions strict = options;
  strict.max_pose_age = 0.2;
  shared.live_for_poses.write(nextOptions(firstOptions(options), strict, 0.0));
  input.accept(wrench, "/device");
  EXPECT_EQ(input.counters().late, 1u);
}

}  // namespace
}  // namespace haptic_cloth::live_options_test
