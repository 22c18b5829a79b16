/// The node's private parameters: defaults, scenes, several probes, and messages about bad values.
#include "ros/options/node_options.h"

#include <gtest/gtest.h>
#include <yaml-cpp/yaml.h>

#include <limits>
#include <string>

#include "ros/options/node_table.h"
#include "ros/support/yaml_parameters.h"
#include "support/reference_file.h"

namespace haptic_cloth::node_options_test {
namespace {

using XmlRpc::XmlRpcValue;

constexpr double kNaN = std::numeric_limits<double>::quiet_NaN();

TEST(NodeOptions, TheShippedFileIsTheTableOfDefaults) {
  expectText("config/node.yaml", defaultParameters());
  NodeOptions plain = parseNodeOptions(sceneParameters(), "test");
  const YAML::Node shipped = YAML::Load(defaultParameters());
  NodeOptions loaded = parseNodeOptions(withSettings(shipped), "test");
  const std::vector<OptionGroup> expected = groupsOf(plain), groups = groupsOf(loaded);
  for (std::size_t g = 0; g < groups.size(); ++g) {
    for (std::size_t k = 0; k < groups[g].options.size(); ++k) {
      EXPECT_EQ(valueText(groups[g].options[k]), valueText(expected[g].options[k]))
          << groups[g].path << groups[g].options[k].key;
    }
  }
}

TEST(NodeOptions, TheReferenceHasTheTables) { expectTables("docs/reference/parameters.md", nodeTables()); }

TEST(NodeOptions, SceneByParametersOrByFile) {
  XmlRpcValue parameters = sceneParameters();
  parameters["haptics"]["max_force"] = 2;
  const NodeOptions direct = parseNodeOptions(parameters, "test");
  EXPECT_EQ(direct.scene.cloth.particles[0], 17);
  EXPECT_EQ(direct.scene.cloth.pins.size(), 4u);
  EXPECT_EQ(direct.haptics.max_force, 2.0);

  XmlRpcValue file;
  file["scene_file"] = std::string(HAPTIC_CLOTH_SOURCE_DIR) + "/test/ros/support/scene.yaml";
  file["probe"]["coupling_stiffness"] = 250.0;
  const NodeOptions loaded = parseNodeOptions(file, "test");
  EXPECT_EQ(loaded.scene.cloth.particles[0], 17);
  EXPECT_EQ(loaded.scene.probes[0].coupling_stiffness, 250.0);
  EXPECT_EQ(loaded.probes[0].haptics.coupling_stiffness, 250.0);
  EXPECT_EQ(startWarnings(direct), std::vector<std::string>());
  EXPECT_EQ(
      startWarnings(loaded),
      std::vector<std::string>{std::string(HAPTIC_CLOTH_SOURCE_DIR) +
                               "/test/ros/support/scene.yaml is overridden by parameters, perhaps those of "
                               "an earlier launch: probe.coupling_stiffness"});
  file["solver"]["tolerance"] = -1.0;
  EXPECT_EQ(messageOf(file).find("/cloth (parameters): solver.tolerance = -1: must be"), 0u)
      << messageOf(file);
}

/// tf2 and rviz know no frames that begin with a slash.
TEST(NodeOptions, AFrameHasNoSlash) {
  XmlRpcValue parameters = sceneParameters();
  parameters["frame_id"] = "/table";
  EXPECT_EQ(parseNodeOptions(parameters, "test").frame_id, "table");
  parameters["frame_id"] = "//table";
  EXPECT_EQ(parseNodeOptions(parameters, "test").frame_id, "table");
  parameters["frame_id"] = "/";
  EXPECT_NE(messageOf(parameters).find("frame_id = ''"), std::string::npos);
}

TEST(NodeOptions, AFabricBesideTheSceneIsFound) {
  // The launch files load a scene as parameters, which do not contain its folder; scene_directory
  // does.
  XmlRpcValue parameters = sceneParameters();
  parameters["cloth"]["fabric"] = "denim_a.yaml";
  EXPECT_NE(messageOf(parameters).find("no such file: denim_a.yaml"), std::string::npos);
  parameters["scene_directory"] = std::string(HAPTIC_CLOTH_SOURCE_DIR) + "/config/fabrics";
  EXPECT_EQ(messageOf(parameters), "");
}

TEST(NodeOptions, EveryProbeHasItsOwnDeviceAndCoupling) {
  const auto with = [](const std::string& devices) {
    XmlRpcValue parameters = sceneParameters();
    parameters["probe"] = toParameter(YAML::Load("{coupling_stiffness: 300, radius: 0.01}"));
    parameters["probes"] = toParameter(YAML::Load("{thumb: {}, index: {coupling_stiffness: 150}}"));
    parameters["device"]["position_scale"] = 2.0;
    parameters["devices"] = toParameter(YAML::Load(devices));
    return parameters;
  };
  const NodeOptions options =
      parseNodeOptions(with("{thumb: {offset: [0, 0, 1], force_scale: 0.5}}"), "test");
  ASSERT_EQ(options.probes.size(), 2u);
  // A map of parameters is sorted by name.
  const int thumb = options.scene.probes[0].name == "thumb" ? 0 : 1, index = 1 - thumb;
  EXPECT_EQ(options.scene.probes[index].name, "index");
  EXPECT_EQ(options.probes[thumb].haptics.coupling_stiffness, 300.0);
  EXPECT_EQ(options.probes[index].haptics.coupling_stiffness, 150.0);
  EXPECT_EQ(options.scene.probes[index].radius, 0.01);
  EXPECT_EQ(options.probes[thumb].device.offset, Vec3(0, 0, 1));
  EXPECT_EQ(options.probes[thumb].device.force_scale, 0.5);
  EXPECT_EQ(options.probes[index].device.offset, Vec3(0, 0, 0));
  EXPECT_EQ(options.probes[index].device.force_scale, 1.0);
  for (const ProbeSettings& probe : options.probes) EXPECT_EQ(probe.device.position_scale, 2.0);
  EXPECT_NE(messageOf(with("{little: {}}")).find("devices/little: unknown parameter"), std::string::npos);
  EXPECT_NE(messageOf(with("{thumb: {ofset: 1}}")).find("devices/thumb/ofset"), std::string::npos);
}

TEST(NodeOptions, TheBudgetOfAStepIsTheSmallerOne) {
  XmlRpcValue parameters = sceneParameters();
  EXPECT_EQ(parseNodeOptions(parameters, "test").scene.solver.minimizer.time_budget, 0.025);
  parameters["solver"]["time_budget"] = 0.01;
  EXPECT_EQ(parseNodeOptions(parameters, "test").scene.solver.minimizer.time_budget, 0.01);
  parameters["solver"]["time_budget"] = 0.5;
  EXPECT_EQ(parseNodeOptions(parameters, "test").scene.solver.minimizer.time_budget, 0.025);
  parameters["step_budget"] = 0;
  EXPECT_EQ(parseNodeOptions(parameters, "test").scene.solver.minimizer.time_budget, 0.5);
}

TEST(NodeOptions, BadOnesAreNamed) {
  const auto with = [](const std::string& key, const XmlRpcValue& value) {
    XmlRpcValue parameters = sceneParameters();
    parameters[key] = value;
    return messageOf(parameters);
  };
  EXPECT_EQ(messageOf(sceneParameters()), "");
  EXPECT_NE(with("frame_id", 7).find("frame_id = 7: must be text"), std::string::npos);
  EXPECT_NE(with("max_pose_age", -1.0).find("max_pose_age = -1: must be >= 0"), std::string::npos);
  EXPECT_NE(with("max_pose_age", kNaN).find("max_pose_age"), std::string::npos);
  EXPECT_NE(with("haptics", 3).find("haptics = 3: must be a mapping"), std::string::npos);
  XmlRpcValue no_scene;
  no_scene["frame_id"] = "table";
  EXPECT_NE(messageOf(no_scene).find("scene_file: is required"), std::string::npos);
  // The known keys are the node's own parameters and the keys of a scene.
  const std::string unknown = with("tpyo", 3);
  EXPECT_NE(unknown.find("tpyo: unknown parameter; known here: "), std::string::npos) << unknown;
  for (const char* known : {"max_pose_age", "haptics", "cloth", "probes"})
    EXPECT_NE(unknown.find(known), std::string::npos) << unknown;
  XmlRpcValue group;
  group["max_farce"] = 3;
  EXPECT_NE(with("haptics", group)
                .find("haptics/max_farce: unknown parameter; known here: admittance, max_force, "),
            std::string::npos);
  EXPECT_NE(messageOf(XmlRpcValue()).find("/cloth (parameters)"), std::string::npos);
}

/// Numbers have the limits of those in scenes, also in the scale of the probe.
TEST(NodeOptions, NumbersThatAreTooLargeOrTooSmallAreNamed) {
  const auto with = [](const std::string& key, double value, double force_scale = 1.0) {
    XmlRpcValue parameters = sceneParameters();
    parameters["haptics"][key] = value;
    parameters["device"]["force_scale"] = force_scale;
    return messageOf(parameters);
  };
  const auto has = [](const std::string& message, const std::string& words) {
    EXPECT_NE(message.find(words), std::string::npos) << message;
  };
  EXPECT_EQ(with("max_force", 1e12), "");
  EXPECT_EQ(with("max_force", 1e-12), "");
  has(with("max_force", 1e300), "haptics/max_force = 1e+300: must be within 1e-12 to 1e12");
  has(with("max_force", 5e-324), "must be within 1e-12 to 1e12");
  has(with("max_force_rate", 1e300), "haptics/max_force_rate = 1e+300: must be within 1e-12 to 1e12");
  has(with("max_torque", 1e300), "haptics/max_torque = 1e+300: must be at most 1e12");
  has(with("ramp_time", 5e-324), "must be within 1e-12 to 1e12");
  EXPECT_EQ(with("max_force", 1e6, 1e-6), "");
  has(with("rate", 5.0), "haptics/rate = 5: must be at least 40: two ticks in haptics/pose_timeout");
  EXPECT_EQ(with("rate", 40.0), "");
  has(with("pose_timeout", 1.5), "probe_timeout = 1: must be at least haptics/pose_timeout = 1.5");
  has(with("snapshot_timeout", 0.007),
      "haptics/snapshot_timeout = 0.007: must be at least two longest steps, 0.008");
  has(with("max_force", 1e7, 1e-6), ", on the probe probe: haptics/max_force = 1e+13: must be within");
}

}  // namespace
}  // namespace haptic_cloth::node_options_test
