/// Parameters of admittance devices: each probe has its kind, bad ones are named.
#include <gtest/gtest.h>

#include "ros/options/node_options.h"
#include "ros/support/yaml_parameters.h"

namespace haptic_cloth::admittance_options_test {
namespace {

using XmlRpc::XmlRpcValue;

TEST(AdmittanceParameters, EveryProbeHasItsKind) {
  XmlRpcValue parameters = sceneParameters();
  parameters["probes"] = toParameter(YAML::Load("{robot: {radius: 0.01}, touch: {radius: 0.01}}"));
  parameters["devices"] = toParameter(YAML::Load("{robot: {kind: admittance}}"));
  parameters["haptics"] = toParameter(YAML::Load("{admittance: {mass: 2}}"));
  const NodeOptions options = parseNodeOptions(parameters, "test");
  ASSERT_EQ(options.probes.size(), 2u);
  for (std::size_t k = 0; k < 2; ++k) {
    const bool robot = options.scene.probes[k].name == "robot";
    EXPECT_EQ(options.probes[k].device.kind, robot ? DeviceKind::Admittance : DeviceKind::Impedance);
    EXPECT_EQ(options.probes[k].haptics.admittance.mass, 2.0);
  }
}

/// An admittance device renders no force, so no coupling is too stiff for it.
TEST(AdmittanceParameters, OnlyImpedanceDevicesWarnOfTheCoupling) {
  XmlRpcValue parameters = sceneParameters();
  parameters["probes"] = toParameter(YAML::Load("{robot: {radius: 0.01}, touch: {radius: 0.01}}"));
  parameters["device"] = toParameter(YAML::Load("{max_stiffness: 100}"));
  parameters["devices"] = toParameter(YAML::Load("{robot: {kind: admittance}}"));
  const std::vector<std::string> warnings = deviceWarnings(parseNodeOptions(parameters, "test"));
  ASSERT_EQ(warnings.size(), 1u);
  EXPECT_EQ(warnings[0].find("touch: "), 0u) << warnings[0];
}

TEST(AdmittanceParameters, BadOnesAreNamed) {
  const auto message = [](const std::string& key, const std::string& value) -> std::string {
    XmlRpcValue parameters = sceneParameters();
    parameters[key] = toParameter(YAML::Load(value));
    return messageOf(parameters);
  };
  const auto expect = [&](const std::string& key, const std::string& value, const std::string& words) {
    EXPECT_NE(message(key, value).find(words), std::string::npos) << message(key, value);
  };
  expect("device", "{kind: magic}", "device/kind = \"magic\": must be one of impedance, admittance");
  expect("device", "{kind: 3}", "device/kind = 3: must be text");
  expect("haptics", "{admittance: {mass: 0}}", "haptics/admittance/mass = 0: must be > 0");
  expect("haptics", "{admittance: {max_sped: 1}}", "haptics/admittance/max_sped: unknown parameter");
  expect("haptics", "{admittance: {start: [0, 0]}}", "must be a list of 3 finite numbers");
  expect("haptics", "{admittance: {start: [0, 0, 7]}}", "haptics/admittance/start");
  expect("haptics", "{admittance: {workspace_high: [0, 0, -1]}}", "haptics/admittance/workspace_high");
}

}  // namespace
}  // namespace haptic_cloth::admittance_options_test
