#include "ros/options/live_options.h"

#include <cmath>

#include "haptic_cloth/error.h"
#include "state/number_text.h"

namespace haptic_cloth {
namespace {

using Field = LiveOption::Field;

LiveValue toValue(int value) { return value; }
LiveValue toValue(double value) { return value; }
LiveValue toValue(MeshColouring value) { return std::string(toString(value)); }

/// Collects the options of one group of parameters.
class Group {
 public:
  Group(const std::string& path, std::vector<LiveOption>& options) : path_(path), options_(options) {}

  /// @param field returns a pointer into NodeOptions, const or not
  template <class Get>
  void add(const std::string& key, const std::string& description, LiveValue low, LiveValue high,
           const Get& field) {
    options_.push_back({path_ + key, description, low, high,
                        [field](NodeOptions& o) -> Field { return field(o); },
                        [field](const NodeOptions& o) { return toValue(*field(o)); }});
  }

 private:
  std::string path_;
  std::vector<LiveOption>& options_;
};

void addNode(Group root) {
  root.add("max_pose_age", "a pose with an older stamp is dropped [s]; 0: never", 0.0, 2.0,
           [](auto& o) { return &o.max_pose_age; });
  root.add("probe_timeout", "without poses this long the probe leaves the scene [s]", 0.1, 10.0,
           [](auto& o) { return &o.probe_timeout; });
  root.add("velocity_time_constant", "low pass of the device's velocity [s]", 0.001, 0.05,
           [](auto& o) { return &o.velocity_time_constant; });
  root.add("step_budget", "wall clock of one step [s]; 0: none", 0.0, 0.1,
           [](auto& o) { return &o.step_budget; });
  root.add("gain_ramp", "in which changed couplings and force scales are reached [s]; 0: at once", 0.0, 5.0,
           [](auto& o) { return &o.gain_ramp; });
  root.add("air_damping", "of the cloth's motion [1/s]", 0.0, 20.0,
           [](auto& o) { return &o.scene.air_damping; });
}

void addHaptics(Group haptics) {
  haptics.add("rate", "ticks of the haptic thread [Hz]", 100.0, 4000.0,
              [](auto& o) { return &o.haptics.rate; });
  haptics.add("max_force", "on the hand [N]", 0.1, 12.0, [](auto& o) { return &o.haptics.max_force; });
  haptics.add("max_force_rate", "on the hand [N/s]", 1.0, 1000.0,
              [](auto& o) { return &o.haptics.max_force_rate; });
  haptics.add("max_torque", "on the hand [N m]; 0: none", 0.0, 1.0,
              [](auto& o) { return &o.haptics.max_torque; });
  haptics.add("soft_start", "the limit rises from zero after start, pause and fault [s]", 0.0, 5.0,
              [](auto& o) { return &o.haptics.soft_start; });
  haptics.add("pose_timeout", "an older pose ramps the force to zero [s]", 0.01, 0.5,
              [](auto& o) { return &o.haptics.pose_timeout; });
  haptics.add("snapshot_timeout", "older news from the solver ramps the force to zero [s]", 0.01, 1.0,
              [](auto& o) { return &o.haptics.snapshot_timeout; });
  haptics.add("ramp_time", "from full force to zero [s]", 0.001, 0.5,
              [](auto& o) { return &o.haptics.ramp_time; });
}

void addPassivity(Group passivity) {
  passivity.add("damping", "largest damping that the controller adds [N s/m]", 0.0, 20.0,
                [](auto& o) { return &o.haptics.passivity.damping; });
  passivity.add("debt", "energy debt that halves the force of the coupling [J]; 0: never", 0.0, 0.01,
                [](auto& o) { return &o.haptics.passivity.debt; });
  passivity.add("store", "most energy put in earlier that may come out again [J]", 0.0, 0.5,
                [](auto& o) { return &o.haptics.passivity.store; });
  passivity.add("device_damping", "of mechanism and hand, which may be counted on [N s/m]", 0.0, 10.0,
                [](auto& o) { return &o.haptics.passivity.device_damping; });
  passivity.add("loop_delay", "from a force leaving to a pose that has felt it, beyond the tick's own [s]",
                0.0, 0.02, [](auto& o) { return &o.haptics.passivity.loop_delay; });
}

void addSolver(Group solver) {
  solver.add("tolerance", "a step is solved when the residual is below this share of gravity [-]", 0.0, 1.0,
             [](auto& o) { return &o.scene.solver.minimizer.tolerance; });
  solver.add("max_iterations", "of one solve", 1, 2000,
             [](auto& o) { return &o.scene.solver.minimizer.max_iterations; });
  solver.add("time_budget", "wall clock of one step [s]; 0: none; the smaller of this and step_budget", 0.0,
             0.1, [](auto& o) { return &o.time_budget; });
  solver.add("sleep_speed", "slower particles fall asleep [m/s]; 0: none", 0.0, 0.01,
             [](auto& o) { return &o.scene.solver.sleep_speed; });
}

void addAdapt(Group adapt) {
  adapt.add("interval", "steps between two looks at the mesh", 1, 100,
            [](auto& o) { return &o.scene.adapt.interval; });
  adapt.add("refine_above", "cells split where the cloth turns more [rad]", 0.01, 3.0,
            [](auto& o) { return &o.scene.adapt.refine_above; });
  adapt.add("coarsen_below", "cells merge where it turns less [rad]", 0.0, 3.0,
            [](auto& o) { return &o.scene.adapt.coarsen_below; });
  adapt.add("refine_above_strain", "cells split where tensile strain differs more [-]", 1e-4, 0.1,
            [](auto& o) { return &o.scene.adapt.refine_above_strain; });
  adapt.add("coarsen_below_strain", "cells merge where it differs less [-]", 0.0, 0.1,
            [](auto& o) { return &o.scene.adapt.coarsen_below_strain; });
  adapt.add("minimum_age", "steps before a new cell may merge", 0, 1000,
            [](auto& o) { return &o.scene.adapt.minimum_age; });
}

void addDisplay(Group markers, Group state) {
  markers.add("rate", "[Hz]", 1.0, 60.0, [](auto& o) { return &o.markers.rate; });
  markers.add("force_scale", "length of the force arrow [m/N]", 0.001, 0.5,
              [](auto& o) { return &o.markers.force_scale; });
  markers.add("colouring", "what the lines of the mesh show: level, tension or bending", std::string(),
              std::string(), [](auto& o) { return &o.markers.colouring; });
  markers.add("full_tension", "at which a line has its full colour [N/m]", 0.1, 500.0,
              [](auto& o) { return &o.markers.full_tension; });
  markers.add("full_bending", "at which a line has its full colour [J/m2]", 1e-4, 1.0,
              [](auto& o) { return &o.markers.full_bending; });
  state.add("rate", "[Hz]", 1.0, 60.0, [](auto& o) { return &o.state_rate; });
}

void addProbe(Group probe, Group device, std::size_t k) {
  probe.add("coupling_stiffness", "of the virtual coupling [N/m]; reached within gain_ramp", 10.0, 5000.0,
            [k](auto& o) { return &o.scene.probes[k].coupling_stiffness; });
  probe.add("coupling_damping", "of the virtual coupling [N s/m]; reached within gain_ramp", 0.0, 20.0,
            [k](auto& o) { return &o.scene.probes[k].coupling_damping; });
  device.add("force_scale", "force on the hand per force on the probe; reached within gain_ramp", 0.01, 10.0,
             [k](auto& o) { return &o.probes[k].device.force_scale; });
}

/// Assigns a value to its field. @return the rule it breaks; empty if it is valid
std::string assign(const Field& field, const LiveValue& value) {
  if (int* const* whole = std::get_if<int*>(&field)) {
    if (!std::holds_alternative<int>(value)) return "must be a whole number";
    **whole = std::get<int>(value);
  } else if (double* const* number = std::get_if<double*>(&field)) {
    if (std::holds_alternative<std::string>(value)) return "must be a number";
    const int* const whole_value = std::get_if<int>(&value);
    **number = whole_value != nullptr ? *whole_value : std::get<double>(value);
  } else if (!std::holds_alternative<std::string>(value)) {
    return "must be text";
  }
  return "";
}

std::string toText(const LiveValue& value) {
  if (const int* whole = std::get_if<int>(&value)) return std::to_string(*whole);
  if (const double* number = std::get_if<double>(&value)) return shortestText(*number);
  return std::get<std::string>(value);
}

Gains gainsOf(const NodeOptions& options, std::size_t k) {
  const ProbeOptions& probe = options.scene.probes[k];
  return {probe.coupling_stiffness, probe.coupling_damping, options.probes[k].device.force_scale};
}

}  // namespace

std::vector<LiveOption> offeredOptions(const NodeOptions& options) {
  std::vector<LiveOption> offered;
  const auto group = [&offered](const std::string& path) { return Group(path, offered); };
  addNode(group(""));
  addHaptics(group("haptics/"));
  addPassivity(group("haptics/passivity/"));
  const std::vector<ProbeOptions>& probes = options.scene.probes;
  for (std::size_t k = 0; k < probes.size(); ++k) {
    const bool only = probes.size() == 1 && probes[k].name == ProbeOptions().name;
    addProbe(group(only ? "probe/" : "probes/" + probes[k].name + "/"),
             group("devices/" + probes[k].name + "/"), k);
  }
  addSolver(group("solver/"));
  addAdapt(group("adapt/"));
  addDisplay(group("markers/"), group("state/"));
  return offered;
}

std::vector<std::string> choices(const LiveOption& option) {
  if (!std::holds_alternative<std::string>(option.low)) return {};
  return {toString(MeshColouring::Level), toString(MeshColouring::Tension), toString(MeshColouring::Bending)};
}

NodeOptions changed(const NodeOptions& options, const LiveValues& values, const std::string& origin) {
  NodeOptions next = options;
  LiveValues left = values;
  for (const LiveOption& option : offeredOptions(options)) {
    const auto entry = left.find(option.name);
    if (entry == left.end()) continue;
    const Field field = option.field(next);
    const std::string broken = assign(field, entry->second);
    if (!broken.empty()) throw InputError(origin, option.name, toText(entry->second), broken);
    if (MeshColouring* const* colouring = std::get_if<MeshColouring*>(&field))
      **colouring = toMeshColouring(std::get<std::string>(entry->second), origin, option.name);
    left.erase(entry);
  }
  if (!left.empty()) {
    throw InputError(origin, left.begin()->first, toText(left.begin()->second),
                     "cannot change while the node runs");
  }
  settle(next);
  validateNodeOptions(next, origin);
  return next;
}

LiveOptions firstOptions(const NodeOptions& options) {
  LiveOptions first;
  first.options = std::make_shared<const NodeOptions>(options);
  for (std::size_t k = 0; k < options.probes.size(); ++k) first.gains.emplace_back(gainsOf(options, k));
  return first;
}

LiveOptions nextOptions(const LiveOptions& last, const NodeOptions& options, double now) {
  LiveOptions next = last;
  ++next.number;
  next.options = std::make_shared<const NodeOptions>(options);
  for (std::size_t k = 0; k < next.gains.size(); ++k) {
    const Gains gains = gainsOf(options, k);
    // A change of another option must not restart the ramps of gains that did not change.
    if (gains != gainsOf(*last.options, k)) next.gains[k] = last.gains[k].onTo(gains, now, options.gain_ramp);
  }
  return next;
}

}  // namespace haptic_cloth
