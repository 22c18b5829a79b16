#include "scene/scene_options.h"

#include <algorithm>
#include <utility>

#include "shape/shapes.h"

namespace haptic_cloth {
namespace {

constexpr Range kLevels{0.0, 8.0}, kThreads{0.0, 1024.0}, kFactor{1.0, 1000.0};
constexpr Range kTimeStep{0.0, 1.0, true};  ///< [s]; cloth moves for about a second

Option airDampingOption(double& air_damping) {
  return {"air_damping",
          field(air_damping),
          kNotNegative,
          "1/s",
          "drag of still air: force per mass and speed",
          Live{0.0, 20.0},
          kInState};
}

}  // namespace

// Key, member, range, unit, sentence; then, unless they are the usual ones: live, part of a state.

Options optionsOf(ClothOptions& cloth) {
  return {
      {"particles", field(cloth.particles), atLeast(2), "", "finest grid, warp (x) and weft (y)", kFixed,
       kInState},
      {"size", field(cloth.size), kLength, "m", "side lengths", kFixed, kInState},
      {"position", field(cloth.pose.position), kPosition, "m", "centre of the flat cloth", kFixed, kInState},
      {"orientation", field(cloth.pose.orientation), kNoRange, "", "grid in the local x-y plane", kFixed,
       kInState},
      {"fabric", OwnReader{"", "required"}, kNoRange, "", "name, or path that ends in `.yaml`"},
      {"pins", OwnReader{"[]", "list"}, kNoRange, "", "particles that are held, see below"},
      {"self_contact", field(cloth.self_contact), kNoRange, "", "layers do not pass through each other",
       kFixed, kInState},
      {"self_friction", field(cloth.self_friction), kNotNegative, "", "Coulomb coefficient of cloth on cloth",
       kFixed, kInState}};
}

Options optionsOf(Pin& pin) {
  return {{"particles", OwnReader{"", "required"}, kNoRange, "", "name, or ranges [[i0, i1], [j0, j1]]"},
          {"velocity", field(pin.velocity), kPosition, "m/s", "of the point `centre`", kFixed, kInState},
          {"turn", field(pin.turn), kPosition, "rad/s", "angular velocity", kFixed, kInState},
          {"centre", field(pin.centre), kPosition, "m", "point of the axis at time 0", kFixed, kInState}};
}

Options optionsOf(StepOptions& options) {
  Options rows{airDampingOption(options.air_damping)};
  const auto append = [&rows](const std::string& prefix, Options group) {
    for (Option& row : group) {
      row.key = prefix + row.key;
      rows.push_back(std::move(row));
    }
  };
  append("solver.", optionsOf(options.solver));
  append("adapt.", optionsOf(options.adapt));
  return rows;
}

Options worldOptions(Scene& scene) {
  return {{"gravity", field(scene.gravity), kPosition, "m/s²", "acceleration of free fall", kFixed, kInState},
          airDampingOption(scene.air_damping),
          {"obstacles", OwnReader{"[]", "list"}, kNoRange, "", "solids, see below"}};
}

Options optionsOf(Obstacle& obstacle) {
  return {
      {"name", OwnReader{"", "text"}, kNoRange, "", "the node moves a named obstacle"},
      {"shape", OwnReader{"", "required"}, kNoRange, "", "see below"},
      {"size", field(obstacle.size), kLength, "m", "full side lengths", kFixed, kInState},
      {"radius", field(obstacle.radius), kLength, "m", "radius of the shape", kFixed, kInState},
      {"length", field(obstacle.length), kLength, "m", "height, or distance of two centres", kFixed,
       kInState},
      {"position", field(obstacle.pose.position), kPosition, "m", "of the shape's centre", kFixed, kInState},
      {"orientation", field(obstacle.pose.orientation), kNoRange, "", "of the shape's axes", kFixed,
       kInState},
      {"friction", field(obstacle.friction), kNotNegative, "", "Coulomb coefficient", kFixed, kInState},
      {"path", OwnReader{"[]", "rows t, x, y, z; t increases"}, kNoRange, "s, m",
       "`simulate` moves the obstacle along it"}};
}

Options couplingOptions(double& stiffness, double& damping) {
  return {{"coupling_stiffness", field(stiffness), kPositive, "N/m", "spring between device and proxy",
           Live{10.0, 5000.0}, kInState},
          {"coupling_damping", field(damping), kNotNegative, "N·s/m", "damper between device and proxy",
           Live{0.0, 20.0}, kInState}};
}

Options optionsOf(ProbeOptions& probe) {
  Options options{
      {"shape", OwnReader{"sphere", "`sphere`, `capsule`"}, kNoRange, "",
       "a capsule's axis is z of the device"},
      {"radius", field(probe.radius), kLength, "m", "see below for its limits", kFixed, kInState},
      {"length", field(probe.length), kDistance, "m",
       "distance of the two centres of a capsule, which must name it", kFixed, kInState},
      {"friction", field(probe.friction), kNotNegative, "", "Coulomb coefficient", kFixed, kInState}};
  for (Option& gain : couplingOptions(probe.coupling_stiffness, probe.coupling_damping)) {
    options.push_back(gain);
  }
  const Options inputs{
      {"path", OwnReader{"[]", "rows t, x, y, z; t increases"}, kNoRange, "s, m", "scripted device position"},
      {"orientation", field(probe.orientation), kNoRange, "", "orientation on the path"},
      {"grasp", OwnReader{"[]", "rows from, to; from < to"}, kNoRange, "s",
       "when the probe is closed on its path"}};
  options.insert(options.end(), inputs.begin(), inputs.end());
  return options;
}

Options optionsOf(SolverOptions& solver) {
  MinimizerOptions& minimizer = solver.minimizer;
  return {{"time_step", field(solver.time_step), kTimeStep, "s", "length of a step", kFixed, kInState},
          {"integrator", field(solver.integrator, integratorNames()), kNoRange, "",
           "backward Euler, or second order in time", kFixed, kInState},
          {"cost", field(solver.cost, costNames()), kNoRange, "", "what is minimised", kFixed, kInState},
          {"preconditioner", field(minimizer.preconditioner, preconditionerNames()), kNoRange, "",
           "scaling of the minimizer's directions", kFixed, kInState},
          {"tolerance", field(minimizer.tolerance), kNotNegative, "",
           "residual at which a step is solved, as a share of gravity", Live{0.0, 1.0}, kInState},
          {"max_iterations", field(minimizer.max_iterations), atLeast(1), "", "limit of one solve",
           Live{1, 2000}, kInState},
          {"time_budget", field(minimizer.time_budget), kNotNegative, "s",
           "wall clock of one step; 0: no limit", Live{0.0, 0.1}},
          {"sleep_speed", field(solver.sleep_speed), kNotNegative, "m/s",
           "below it particles fall asleep; 0: never", Live{0.0, 0.01}, kInState},
          {"threads", field(solver.threads), kThreads, "", "limit; 0: one per core, or `OMP_NUM_THREADS`"}};
}

Options optionsOf(AdaptOptions& adapt) {
  return {{"strategy", field(adapt.strategy, strategyNames()), kNoRange, "", "changes the mesh may make",
           kFixed, kInState},
          // Work is counted from this mesh.
          {"start", field(adapt.start, startNames()), kNoRange, "",
           "initial mesh of `amrc`; the other strategies have their own", kFixed, kInState},
          {"levels", field(adapt.levels), kLevels, "", "the coarsest cell is 2^levels finest cells wide",
           kFixed, kInState},
          {"interval", field(adapt.interval), atLeast(1), "",
           "time steps between two decisions about the mesh", Live{1, 100}, kInState},
          {"refine_above", field(adapt.refine_above), kPositive, "rad",
           "turning angle above which a cell splits", Live{0.01, 3.0}, kInState},
          {"coarsen_below", field(adapt.coarsen_below), kNotNegative, "rad",
           "angle below which four cells merge; < `refine_above`", Live{0.0, 3.0}, kInState},
          {"refine_above_strain", field(adapt.refine_above_strain), kPositive, "",
           "strain difference above which a cell splits", Live{1e-4, 0.1}, kInState},
          {"coarsen_below_strain", field(adapt.coarsen_below_strain), kNotNegative, "",
           "the same, for merging; < `refine_above_strain`", Live{0.0, 0.1}, kInState},
          {"far_angle_factor", field(adapt.far_angle_factor), kFactor, "",
           "factor of both angles far from probes", Live{1.0, 10.0}, kInState},
          {"far_strain_factor", field(adapt.far_strain_factor), kFactor, "",
           "factor of both strain differences far from probes", Live{1.0, 100.0}, kInState},
          {"near_reach", field(adapt.near_reach), kNotNegative, "finest cells",
           "cells within this distance of the finest ones of a probe that touches are near it",
           Live{0.0, 20.0}, kInState},
          {"near_load", field(adapt.near_load), kNotNegative, "",
           "so are cells whose tension carries a larger share of the largest probe force, or of the weight "
           "if that is more",
           Live{0.0, 1.0}, kInState},
          {"minimum_age", field(adapt.minimum_age), atLeast(0), "", "time steps before a new cell may merge",
           Live{0, 1000}, kInState}};
}

Options optionsOf(StopOptions& stop) {
  return {{"time", field(stop.time), kPositive, "s", "simulated time at which `simulate` ends"},
          {"rest_speed", field(stop.rest_speed), kNotNegative, "m/s",
           "`simulate` ends early once all paths and grasps are over and the cloth was slower for 0.1 s; 0: "
           "never"}};
}

Options ownOptions(Obstacle& obstacle) {
  const std::vector<std::string> own = dimensionsOf(obstacle.shape);
  const auto has = [](const std::vector<std::string>& keys, const std::string& key) {
    return std::find(keys.begin(), keys.end(), key) != keys.end();
  };
  const auto foreign = [&](const Option& option) {
    if (has(own, option.key)) return false;
    for (const auto& entry : shapeNames()) {
      if (has(dimensionsOf(entry.second), option.key)) return true;
    }
    return false;
  };
  Options options = optionsOf(obstacle);
  options.erase(std::remove_if(options.begin(), options.end(), foreign), options.end());
  return options;
}

std::string probeKey(const Scene& scene, const ProbeOptions& probe, char separator) {
  const bool only = scene.probes.size() == 1 && probe.name == ProbeOptions().name;
  return only ? "probe" : "probes" + (separator + probe.name);
}

std::vector<std::pair<std::string, std::string>> sceneTables() {
  Scene scene;
  Obstacle obstacle;
  Pin pin{};
  return {{"cloth", markdownTable({"cloth.", "", optionsOf(scene.cloth)})},
          {"pins", markdownTable({"", "", optionsOf(pin)})},
          {"world", markdownTable({"", "", worldOptions(scene)})},
          {"obstacles", markdownTable({"", "", ownOptions(obstacle)})},
          {"probe", markdownTable({"probe.", "", optionsOf(scene.probes[0])})},
          {"solver", markdownTable({"solver.", "", optionsOf(scene.solver)})},
          {"adapt", markdownTable({"adapt.", "", optionsOf(scene.adapt)})},
          {"stop", markdownTable({"stop.", "", optionsOf(scene.stop)})}};
}

}  // namespace haptic_cloth
