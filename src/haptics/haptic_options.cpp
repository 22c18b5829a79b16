#include "haptics/haptic_options.h"

#include "haptic_cloth/error.h"
#include "scene/scene_options.h"
#include "state/number_text.h"

namespace haptic_cloth {
namespace {

/// Slower a thread would not hear of its end, faster it would keep its core for itself [Hz].
constexpr Range kRates{1.0, kMostTickRate};

Options hapticOptions(HapticOptions& haptics) {
  return {
      {"rate", field(haptics.rate), kRates, "Hz",
       "rate of the ticks of the haptic thread; `pose_timeout` lasts at least two", Live{100.0, 4000.0}},
      {"max_force", field(haptics.max_force), kPositive, "N",
       "largest force on the hand; for `admittance` the largest force of the hand that counts",
       Live{0.1, 12.0}},
      {"max_force_rate", field(haptics.max_force_rate), kPositive, "N/s",
       "largest change of the force on the hand", Live{1.0, 1000.0}},
      {"max_torque", field(haptics.max_torque), kNotNegative, "N·m", "largest torque on the hand; 0: none",
       Live{0.0, 1.0}},
      {"soft_start", field(haptics.soft_start), kNotNegative, "s",
       "rise of the limits after start, pause and fault", Live{0.0, 5.0}},
      {"pose_timeout", field(haptics.pose_timeout), kPositive, "s", "an older pose ramps the force to zero",
       Live{0.01, 0.5}},
      {"snapshot_timeout", field(haptics.snapshot_timeout), kPositive, "s",
       "an older snapshot of the solver ramps the force to zero", Live{0.01, 1.0}},
      {"ramp_time", field(haptics.ramp_time), kPositive, "s", "from full force to zero", Live{0.001, 0.5}}};
}

Options passivityOptions(PassivityOptions& passivity) {
  return {{"damping", field(passivity.damping), kNotNegative, "N·s/m",
           "largest damping that the controller adds", Live{0.0, 20.0}},
          {"debt", field(passivity.debt), kNotNegative, "J",
           "energy debt that halves the coupling's force; 0: never", Live{0.0, 0.01}},
          {"store", field(passivity.store), kNotNegative, "J", "energy in the cloth that may come out again",
           Live{0.0, 0.5}},
          {"device_damping", field(passivity.device_damping), kNotNegative, "N·s/m",
           "damping that mechanism and hand have at least", Live{0.0, 10.0}},
          {"loop_delay", field(passivity.loop_delay), Range{0.0, kMostLoopDelay}, "s",
           "from a force to the pose that it moved, without the tick itself", Live{0.0, 0.02}}};
}

Options admittanceOptions(AdmittanceOptions& tool) {
  return {
      {"mass", field(tool.mass), kPositive, "kg", "mass of the tool"},
      {"damping", field(tool.damping), kPositive, "N·s/m",
       "in free space a force F leads to the speed F/damping"},
      {"deadband", field(tool.deadband), kNotNegative, "N",
       "subtracted from every force, against sensor drift"},
      {"force_timeout", field(tool.force_timeout), kPositive, "s", "after an older force the tool brakes"},
      {"max_speed", field(tool.max_speed), kPositive, "m/s", "largest speed"},
      {"max_acceleration", field(tool.max_acceleration), kPositive, "m/s²",
       "largest acceleration, also in braking"},
      {"start", field(tool.start), kPosition, "m", "in the workspace; if the device has sent no pose"},
      {"workspace_low", field(tool.workspace_low), kPosition, "m", "corner of the tool's box"},
      {"workspace_high", field(tool.workspace_high), kPosition, "m",
       "opposite corner; above `workspace_low`"}};
}

void checkWorkspace(const AdmittanceOptions& tool, const std::string& origin) {
  const auto fail = [&](const char* key, double value, const char* rule) {
    throw InputError(origin, std::string("haptics/admittance/") + key, shortestText(value), rule);
  };
  for (int c = 0; c < 3; ++c) {
    const double low = tool.workspace_low[c], high = tool.workspace_high[c], start = tool.start[c];
    if (!(high > low)) fail("workspace_high", high, "must be above workspace_low");
    if (!(start >= low && start <= high)) fail("start", start, "must lie in the workspace");
  }
}

/// Silence has to be noticed in time, and the solver has to get poses before they are too old. A probe that
/// leaves between two poses would leave and enter the scene again and again.
void checkTimes(const HapticOptions& options, const std::string& origin) {
  if (options.probe_timeout < options.pose_timeout)
    throw InputError(origin, "probe_timeout", shortestText(options.probe_timeout),
                     "must be at least haptics/pose_timeout = " + shortestText(options.pose_timeout));
  constexpr double kTicks = 2.0;
  const double least = kTicks / options.pose_timeout;
  if (options.rate < least)
    throw InputError(origin, "haptics/rate", shortestText(options.rate),
                     "must be at least " + shortestText(least) + ": two ticks in haptics/pose_timeout");
}

}  // namespace

std::vector<OptionGroup> groupsOf(HapticOptions& haptics) {
  return {{"haptics/", "limits of the force", hapticOptions(haptics)},
          {"haptics/passivity/", "dissipates energy that the loop has created",
           passivityOptions(haptics.passivity)},
          {"haptics/admittance/", "virtual tool, as the hand feels it; in the cloth's frame",
           admittanceOptions(haptics.admittance)}};
}

Options poseOptions(HapticOptions& haptics) {
  return {{"probe_timeout", field(haptics.probe_timeout), kPositive, "s",
           "after this silence the probe leaves the scene", Live{0.1, 10.0}},
          {"velocity_time_constant", field(haptics.velocity_time_constant), kPositive, "s",
           "low-pass filter of the device's velocity", Live{0.001, 0.05}}};
}

void validateHapticOptions(const HapticOptions& options, const std::string& origin) {
  HapticOptions haptics = options;  // rows point to members that could be written
  const auto locate = [&origin](const std::string&) { return origin; };
  for (const OptionGroup& group : groupsOf(haptics)) checkOptions(group.options, group.path, locate);
  checkOptions(poseOptions(haptics), "", locate);
  checkOptions(couplingOptions(haptics.coupling_stiffness, haptics.coupling_damping), "probe.", locate);
  checkTimes(haptics, origin);
  checkWorkspace(haptics.admittance, origin);
}

}  // namespace haptic_cloth
