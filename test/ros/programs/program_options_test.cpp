/// Parameters of the programs beside the node: the page of the reference, wrong and removed keys.
#include "ros/programs/program_options.h"

#include <gtest/gtest.h>

#include <string>

#include "haptic_cloth/error.h"
#include "ros/input/device_adapter.h"
#include "ros/programs/parameters.h"
#include "support/reference_file.h"

namespace haptic_cloth::program_options_test {
namespace {

using XmlRpc::XmlRpcValue;

/// @return the error message; empty if the parameters are accepted
template <class ProgramOptions>
std::string messageOf(const XmlRpcValue& parameters) {
  try {
    readProgramOptions<ProgramOptions>(parameters, "/program (parameters)");
  } catch (const InputError& error) {
    return error.what();
  }
  return "";
}

TEST(ProgramOptions, TheReferenceHasTheTables) {
  expectTables("docs/reference/programs.md", programTables());
}

TEST(ProgramOptions, ReadsValuesAndKeepsDefaults) {
  XmlRpcValue parameters;
  parameters["rate"] = 500;
  parameters["press"][0] = 0.01;
  parameters["press"][1] = 0.0;
  parameters["press"][2] = 0.04;
  const auto hand = readProgramOptions<HandOptions>(parameters, "test");
  EXPECT_EQ(hand.rate, 500.0);
  EXPECT_EQ(hand.press, Vec3(0.01, 0.0, 0.04));
  EXPECT_EQ(hand.mass, HandOptions().mass);
  EXPECT_EQ(readProgramOptions<MonitorOptions>(XmlRpcValue(), "test").node, MonitorOptions().node);
}

TEST(ProgramOptions, SaysWhatIsWrong) {
  XmlRpcValue zero, unknown;
  zero["rate"] = 0.0;
  unknown["speed"] = 1.0;
  EXPECT_EQ(messageOf<PathHandOptions>(zero), "/program (parameters): rate = 0: must be finite and >= 1");
  EXPECT_EQ(messageOf<PathHandOptions>(unknown),
            "/program (parameters): speed: unknown parameter; known here: node, rate, repeat_after");
}

/// latency_probe counts whole seconds: it needs at least one.
TEST(ProgramOptions, AMeasurementTakesWholeSeconds) {
  XmlRpcValue parameters;
  parameters["seconds"] = 0.5;
  EXPECT_EQ(messageOf<LatencyProbeOptions>(parameters),
            "/program (parameters): seconds = 0.5: must be a whole number");
  parameters["seconds"] = 0;
  EXPECT_EQ(messageOf<LatencyProbeOptions>(parameters), "/program (parameters): seconds = 0: must be >= 1");
  parameters["seconds"] = 2;
  EXPECT_EQ(messageOf<LatencyProbeOptions>(parameters), "");
}

TEST(ProgramOptions, ARemovedKeyNamesWhatReplacesIt) {
  for (const std::string key : {"pose/field", "force/field", "force/definition"}) {
    const std::size_t slash = key.find('/');
    XmlRpcValue parameters;
    parameters[key.substr(0, slash)][key.substr(slash + 1)] = std::string("position");
    EXPECT_EQ(messageOf<AdapterOptions>(parameters),
              "/program (parameters): " + key +
                  " = \"position\": no longer exists: the adapter knows the types in docs/guide/devices.md");
  }
}

}  // namespace
}  // namespace haptic_cloth::program_options_test
