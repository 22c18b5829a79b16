/// Scene files: every key is used, every default stays, and every error is named.
#include "haptic_cloth/scene.h"

#include <gtest/gtest.h>
#include <unistd.h>

#include <cmath>
#include <filesystem>
#include <fstream>
#include <limits>
#include <string>
#include <vector>

#include "haptic_cloth/error.h"
#include "scene/option.h"
#include "shape/shapes.h"

namespace haptic_cloth::scene_test {
namespace {

namespace fs = std::filesystem;

constexpr char kCloth[] = "cloth: {fabric: linear}\n";

Scene parse(const std::string& yaml, const std::vector<std::string>& overrides = {}) {
  return parseScene(yaml, "scene", "/nowhere", overrides);
}

/// Message of the error when `yaml` is parsed; "" if it succeeds.
std::string message(const std::string& yaml, const std::vector<std::string>& overrides = {}) {
  try {
    parse(yaml, overrides);
  } catch (const InputError& error) {
    const std::string what = error.what();
    EXPECT_EQ(what.find('\n'), std::string::npos) << what;
    return what;
  }
  return {};
}

struct Case {
  std::string yaml, expected;
};

void expectMessages(const std::vector<Case>& cases) {
  for (const Case& one : cases) EXPECT_EQ(message(one.yaml), one.expected) << one.yaml;
}

/// A cloth with a fabric and more keys; the rest of the scene follows.
std::string withCloth(const std::string& keys) { return "cloth: {fabric: linear, " + keys + "}\n"; }

TEST(Scene, AnObstacleStartsOnItsPathIfItHasNoPosition) {
  const std::string cloth = "cloth: {particles: [5, 5], size: [0.1, 0.1], fabric: linear}\n",
                    path = "path: [[0.5, 1, 2, 3], [1, 4, 5, 6]]";
  const auto startOf = [&](const std::string& position) {
    return parse(cloth + "obstacles: [{shape: sphere, radius: 0.1, " + position + path + "}]")
        .obstacles[0]
        .pose.position;
  };
  EXPECT_EQ(startOf(""), Vec3(1, 2, 3)) << "it holds its first place until 0.5 s";
  EXPECT_EQ(startOf("position: [0, 0, 1], "), Vec3(0, 0, 1));
}

TEST(Scene, DefaultsAreThoseOfTheStructs) {
  const Scene scene = parse(kCloth);
  const Scene plain;
  EXPECT_EQ(scene.cloth.particles, plain.cloth.particles);
  EXPECT_EQ(scene.cloth.size, plain.cloth.size);
  EXPECT_EQ(scene.cloth.pose.position, plain.cloth.pose.position);
  EXPECT_EQ(scene.cloth.fabric.name, "linear");
  EXPECT_EQ(scene.cloth.self_contact, plain.cloth.self_contact);
  EXPECT_EQ(scene.cloth.self_friction, plain.cloth.self_friction);
  EXPECT_EQ(scene.gravity, plain.gravity);
  EXPECT_EQ(scene.air_damping, plain.air_damping);
  EXPECT_TRUE(scene.obstacles.empty());
  EXPECT_EQ(scene.probes[0].radius, plain.probes[0].radius);
  EXPECT_EQ(scene.solver.time_step, plain.solver.time_step);
  EXPECT_EQ(scene.solver.minimizer.max_iterations, plain.solver.minimizer.max_iterations);
  EXPECT_EQ(scene.adapt.refine_above, plain.adapt.refine_above);
  EXPECT_EQ(scene.stop.time, plain.stop.time);
}

TEST(Scene, EveryKeyArrives) {
  const Scene scene = parse(R"(
cloth:
  particles: [9, 17]
  size: [0.1, 0.2]
  position: [1, 2, 3]
  orientation: [0, 0, 0.70710678, 0.70710678]
  fabric: linear
  pins: [edge_x1, {particles: [[1, 2], [3, 4]]}]
  self_contact: false
  self_friction: 0.4
gravity: [0, 1, -2]
air_damping: 0.25
obstacles: []
probe: {radius: 0.01, friction: 0.5, coupling_stiffness: 300, coupling_damping: 2, path: [[0, 1, 2, 3], [1, 4, 5, 6]]}
solver: {time_step: 0.002, cost: condensed, preconditioner: none, tolerance: 0.3, max_iterations: 7,
         time_budget: 0.01, threads: 3}
adapt: {strategy: refine, levels: 3, interval: 5, refine_above: 0.4, coarsen_below: 0.3,
        refine_above_strain: 0.02, coarsen_below_strain: 0.01, far_angle_factor: 2.5, far_strain_factor: 3.5,
        near_reach: 4.5, near_load: 0.05, minimum_age: 6}
stop: {time: 4, rest_speed: 0.001}
)");
  EXPECT_EQ(scene.cloth.particles, (std::array<int, 2>{9, 17}));
  EXPECT_EQ(scene.cloth.size, (std::array<double, 2>{0.1, 0.2}));
  EXPECT_EQ(scene.cloth.pose.position, Vec3(1, 2, 3));
  EXPECT_TRUE((scene.cloth.pose.orientation * Vec3::UnitX()).isApprox(Vec3::UnitY(), 1e-7));
  EXPECT_NEAR(scene.cloth.pose.orientation.norm(), 1.0, 1e-15);
  ASSERT_EQ(scene.cloth.pins.size(), 2U);
  EXPECT_EQ(scene.cloth.pins[1].i0, 1);
  EXPECT_EQ(scene.cloth.pins[1].i1, 2);
  EXPECT_EQ(scene.cloth.pins[1].j0, 3);
  EXPECT_EQ(scene.cloth.pins[1].j1, 4);
  EXPECT_FALSE(scene.cloth.self_contact);
  EXPECT_EQ(scene.cloth.self_friction, 0.4);
  EXPECT_EQ(scene.gravity, Vec3(0, 1, -2));
  EXPECT_EQ(scene.air_damping, 0.25);
  EXPECT_EQ(scene.probes[0].radius, 0.01);
  EXPECT_EQ(scene.probes[0].friction, 0.5);
  EXPECT_EQ(scene.probes[0].coupling_stiffness, 300);
  EXPECT_EQ(scene.probes[0].coupling_damping, 2);
  ASSERT_EQ(scene.probes[0].path.size(), 2U);
  EXPECT_EQ(scene.probes[0].path[1].time, 1);
  EXPECT_EQ(scene.probes[0].path[1].position, Vec3(4, 5, 6));
  EXPECT_EQ(scene.solver.time_step, 0.002);
  EXPECT_EQ(scene.solver.minimizer.preconditioner, Preconditioner::None);
  EXPECT_EQ(scene.solver.minimizer.tolerance, 0.3);
  EXPECT_EQ(scene.solver.minimizer.max_iterations, 7);
  EXPECT_EQ(scene.solver.minimizer.time_budget, 0.01);
  EXPECT_EQ(scene.solver.threads, 3);
  EXPECT_EQ(scene.adapt.strategy, Strategy::Refine);
  EXPECT_EQ(scene.adapt.levels, 3);
  EXPECT_EQ(scene.adapt.interval, 5);
  EXPECT_EQ(scene.adapt.refine_above, 0.4);
  EXPECT_EQ(scene.adapt.coarsen_below, 0.3);
  EXPECT_EQ(scene.adapt.refine_above_strain, 0.02);
  EXPECT_EQ(scene.adapt.coarsen_below_strain, 0.01);
  EXPECT_EQ(scene.adapt.far_angle_factor, 2.5);
  EXPECT_EQ(scene.adapt.far_strain_factor, 3.5);
  EXPECT_EQ(scene.adapt.near_reach, 4.5);
  EXPECT_EQ(scene.adapt.near_load, 0.05);
  EXPECT_EQ(scene.adapt.minimum_age, 6);
  EXPECT_EQ(scene.stop.time, 4);
  EXPECT_EQ(scene.stop.rest_speed, 0.001);
}

TEST(Scene, NamedPinsAreCornersAndEdgesOfTheGrid) {
  const Scene scene =
      parse(withCloth("particles: [5, 9], pins: [corner_00, corner_10, corner_01, corner_11, "
                      "edge_x0, edge_x1, edge_y0, edge_y1]"));
  const std::vector<std::array<int, 4>> expected{{0, 0, 0, 0}, {4, 4, 0, 0}, {0, 0, 8, 8}, {4, 4, 8, 8},
                                                 {0, 0, 0, 8}, {4, 4, 0, 8}, {0, 4, 0, 0}, {0, 4, 8, 8}};
  ASSERT_EQ(scene.cloth.pins.size(), expected.size());
  for (std::size_t p = 0; p < expected.size(); ++p) {
    const Pin& pin = scene.cloth.pins[p];
    EXPECT_EQ((std::array<int, 4>{pin.i0, pin.i1, pin.j0, pin.j1}), expected[p]) << p;
  }
}

TEST(Scene, PinsMove) {
  const Scene scene = parse(withCloth(
      "particles: [5, 9], pins: [edge_x0, {particles: edge_x1, velocity: [1, 2, 3], turn: [4, 5, 6], "
      "centre: [7, 8, 9]}, {particles: [[1, 2], [3, 4]], turn: [0, 0, 1]}]"));
  ASSERT_EQ(scene.cloth.pins.size(), 3U);
  EXPECT_FALSE(scene.cloth.pins[0].moves());
  const Pin& edge = scene.cloth.pins[1];
  EXPECT_EQ((std::array<int, 4>{edge.i0, edge.i1, edge.j0, edge.j1}), (std::array<int, 4>{4, 4, 0, 8}));
  EXPECT_EQ(edge.velocity, Vec3(1, 2, 3));
  EXPECT_EQ(edge.turn, Vec3(4, 5, 6));
  EXPECT_EQ(edge.centre, Vec3(7, 8, 9));
  EXPECT_TRUE(scene.cloth.pins[2].moves());
  EXPECT_EQ(scene.cloth.pins[2].j1, 4);
  expectMessages(
      {{withCloth("pins: [{particles: edge}]"),
        "scene: cloth.pins[0].particles = edge: must be one of corner_00, corner_10, corner_01, "
        "corner_11, edge_x0, edge_x1, edge_y0, edge_y1"},
       {withCloth("pins: [{particles: edge_x0, spin: 1}]"),
        "scene: cloth.pins[0].spin: unknown key; known here: particles, velocity, turn, centre"},
       {withCloth("pins: [{particles: edge_x0, turn: [1, 2]}]"),
        "scene: cloth.pins[0].turn = [1, 2]: must be a list of 3 numbers"},
       {withCloth("pins: [{velocity: [0, 0, 1]}]"), "scene: cloth.pins[0].particles: is required"}});
}

TEST(Scene, EveryShape) {
  const Scene scene = parse(std::string(kCloth) + R"(obstacles:
  - {shape: box, size: [1, 2, 3], position: [4, 5, 6], orientation: [1, 0, 0, 0], friction: 0.7}
  - {shape: sphere, radius: 0.1}
  - {shape: cylinder, radius: 0.2, length: 0.3}
  - {shape: capsule, radius: 0.4, length: 0.5}
  - {shape: plane}
)");
  ASSERT_EQ(scene.obstacles.size(), 5U);
  const Obstacle& box = scene.obstacles[0];
  EXPECT_EQ(box.shape, Shape::Box);
  EXPECT_EQ(box.size, Vec3(1, 2, 3));
  EXPECT_EQ(box.pose.position, Vec3(4, 5, 6));
  EXPECT_TRUE((box.pose.orientation * Vec3::UnitZ()).isApprox(-Vec3::UnitZ()));
  EXPECT_EQ(box.friction, 0.7);
  EXPECT_EQ(scene.obstacles[1].shape, Shape::Sphere);
  EXPECT_EQ(scene.obstacles[1].radius, 0.1);
  EXPECT_EQ(scene.obstacles[1].friction, Obstacle().friction);
  EXPECT_EQ(scene.obstacles[2].shape, Shape::Cylinder);
  EXPECT_EQ(scene.obstacles[2].length, 0.3);
  EXPECT_EQ(scene.obstacles[3].shape, Shape::Capsule);
  EXPECT_EQ(scene.obstacles[3].radius, 0.4);
  EXPECT_EQ(scene.obstacles[3].length, 0.5);
  EXPECT_EQ(scene.obstacles[4].shape, Shape::Plane);
}

TEST(Scene, QuaternionsAlmostUnitAreNormalised) {
  EXPECT_NEAR(parse(withCloth("orientation: [0, 0, 0, 1.0009]")).cloth.pose.orientation.norm(), 1.0, 1e-15);
  EXPECT_EQ(message(withCloth("orientation: [0, 0, 0, 1.002]")),
            "scene: cloth.orientation = [0, 0, 0, 1.002]: must be a unit quaternion x y z w");
  EXPECT_EQ(message(withCloth("orientation: [0, 0, 0, 0]")),
            "scene: cloth.orientation = [0, 0, 0, 0]: must not be zero: a unit quaternion x y z w");
}

TEST(Scene, WrongDocumentsAreNamed) {
  expectMessages(
      {{"", "scene: is empty, must be a YAML mapping"},
       {"# only a comment\n", "scene: is empty, must be a YAML mapping"},
       {"text", "scene: text: must be a YAML mapping"},
       {"{}", "scene: cloth: is required, with cloth.fabric in it"},
       {"cloth: {}", "scene: cloth.fabric: is required"},
       {"cloth: {fabric: [a]}", "scene: cloth.fabric = [a]: must be text"},
       {"cloth: {fabric: \"\"}", "scene: cloth.fabric = \"\": must not be empty"},
       {"cloth: {fabric: \"a\\0b\"}", "scene: cloth.fabric = \"a b\": must be text without a NUL character"},
       {"cloth: {fabric: linear}\n---\na: b", "scene: must hold one YAML document, not several"}});
  EXPECT_EQ(message("cloth: [").find("scene: malformed YAML: "), 0U);
  EXPECT_EQ(message("cloth: {fabric: no_such}")
                .find("scene: cloth.fabric = no_such: must be a fabric's name or the path of a .yaml file; "
                      "no such file: /fabrics/no_such.yaml, "),
            0U)
      << message("cloth: {fabric: no_such}");
  EXPECT_EQ(
      message("cloth: {fabric: a/b.yaml}"),
      "scene: cloth.fabric = a/b.yaml: must be a fabric's name or the path of a .yaml file; no such "
      "file: /nowhere/a/b.yaml; names: cotton_twill, cupro, denim_a, denim_b, denim_c, denim_d, denim_e, "
      "denim_f, linear, polyester_faille, stretch_twill, winter_suiting, wool_tropical");
}

TEST(Scene, UnknownAndDuplicateKeysAreNamed) {
  const std::string ok = kCloth;
  expectMessages(
      {{withCloth("partciles: [3, 3]"),
        "scene: cloth.partciles: unknown key; known here: particles, size, position, orientation, fabric, "
        "pins, self_contact, self_friction"},
       {ok + "gravty: 1",
        "scene: gravty: unknown key; known here: cloth, gravity, air_damping, obstacles, probe, probes, "
        "solver, "
        "adapt, stop"},
       {ok + "solver: {dt: 1}",
        "scene: solver.dt: unknown key; known here: time_step, integrator, cost, preconditioner, tolerance, "
        "max_iterations, time_budget, sleep_speed, threads"},
       {ok + "adapt: {level: 1}",
        "scene: adapt.level: unknown key; known here: strategy, start, levels, interval, refine_above, "
        "coarsen_below, refine_above_strain, coarsen_below_strain, far_angle_factor, far_strain_factor, "
        "near_reach, near_load, minimum_age"},
       {ok + "probe: {r: 1}",
        "scene: probe.r: unknown key; known here: shape, radius, length, friction, "
        "coupling_stiffness, coupling_damping, path, orientation, grasp"},
       {ok + "stop: {t: 1}", "scene: stop.t: unknown key; known here: time, rest_speed"},
       {ok + "obstacles: [{shape: plane, radius: 1}]",
        "scene: obstacles[0].radius: unknown key; known here: name, shape, position, orientation, friction, "
        "path"},
       {ok + "obstacles: [{shape: sphere}]", "scene: obstacles[0].radius: is required for this shape"},
       {ok + "obstacles: [{radius: 1}]", "scene: obstacles[0].shape: is required"},
       {ok + "? [a, b]\n: 1\n",
        "scene: [a, b]: unknown key; known here: cloth, gravity, air_damping, obstacles, probe, probes, "
        "solver, "
        "adapt, stop"},
       {ok + "air_damping: 1\nair_damping: 2\n", "scene: air_damping: must not stand here twice"}});
}

TEST(Scene, MessagesAreOneLineWhateverTheFileHolds) {
  // message() checks for line ends.
  EXPECT_EQ(message(std::string(kCloth) + "probes: {\"a\\nb\": {radius: 0}}"),
            "scene: probes = a b: a name must be a letter, then letters, digits and underscores");
  EXPECT_EQ(message("cloth: {fabric: \"a\\nb\"}").substr(0, 29), "scene: cloth.fabric = \"a b\": ");
}

TEST(Scene, WrongTypesAreNamed) {
  std::vector<std::string> shapes;
  for (const auto& entry : shapeNames()) shapes.push_back(entry.first);
  const std::string ok = kCloth;
  expectMessages(
      {{ok + "gravity: 9.81", "scene: gravity = 9.81: must be a list of 3 numbers"},
       {ok + "gravity: [0, 9.81]", "scene: gravity = [0, 9.81]: must be a list of 3 numbers"},
       {ok + "gravity: [0, 0, down]", "scene: gravity[2] = down: must be a finite number"},
       {ok + "air_damping: .inf", "scene: air_damping = .inf: must be a finite number"},
       {ok + "air_damping: 1,5", "scene: air_damping = 1,5: must be a finite number"},
       {ok + "air_damping: yes", "scene: air_damping = yes: must be a finite number"},
       {ok + "air_damping: 1e", "scene: air_damping = 1e: must be a finite number"},
       {ok + "air_damping:", "scene: air_damping = (nothing): must be a finite number"},
       {ok + "obstacles: {}", "scene: obstacles = {}: must be a list"},
       {ok + "obstacles: [box]",
        "scene: obstacles[0] = box: must be a mapping with keys out of: name, shape, size, radius, "
        "length, position, orientation, friction, path"},
       {ok + "obstacles: [{shape: brick}]", "scene: obstacles[0].shape = brick: " + oneOf(shapes)},
       {ok + "solver: 3",
        "scene: solver = 3: must be a mapping with keys out of: time_step, integrator, cost, preconditioner, "
        "tolerance, "
        "max_iterations, time_budget, sleep_speed, threads"},
       {ok + "solver: {max_iterations: 0.1}", "scene: solver.max_iterations = 0.1: must be an integer"},
       {ok + "solver: {threads: 99999999999}",
        "scene: solver.threads = 99999999999: must be within -2147483648 to 2147483647"},
       {ok + "solver: {threads: \"2\"}", "scene: solver.threads = \"2\": must be an integer"},
       {ok + "solver: {cost: split}", "scene: solver.cost = split: must be one of condensed, joint"},
       {ok + "solver: {preconditioner: ilu}",
        "scene: solver.preconditioner = ilu: must be one of multilevel, jacobi, none"},
       {ok + "adapt: {strategy: fine}",
        "scene: adapt.strategy = fine: must be one of finest, coarsest, refine, coarsen, amrc"},
       {ok + "probe: {path: [[0, 0, 0]]}", "scene: probe.path[0] = [0, 0, 0]: must be a list of 4 numbers"},
       {withCloth("particles: 77"), "scene: cloth.particles = 77: must be a list of 2 integers"},
       {withCloth("particles: [77, 77.0]"), "scene: cloth.particles[1] = 77.0: must be an integer"},
       {withCloth("pins: corner_00"), "scene: cloth.pins = corner_00: must be a list"},
       {withCloth("pins: [corner]"),
        "scene: cloth.pins[0] = corner: must be one of corner_00, corner_10, corner_01, corner_11, edge_x0, "
        "edge_x1, edge_y0, edge_y1"},
       {withCloth("pins: [{particles: [0, 1]}]"),
        "scene: cloth.pins[0].particles[0] = 0: must be a list of 2 integers"}});
}

TEST(Scene, ImpossibleValuesAreNamed) {
  const std::string ok = kCloth;
  expectMessages(
      {{withCloth("particles: [1, 77]"), "scene: cloth.particles[0] = 1: must be >= 2"},
       {withCloth("particles: [-2147483648, 77], pins: [edge_x1]"),
        "scene: cloth.particles[0] = -2147483648: must be >= 2"},
       {withCloth("particles: [77, 78]"),
        "scene: cloth.particles[1] = 78: particles - 1 must be divisible by 2^adapt.levels = 4"},
       {withCloth("particles: [40001, 40001]"),
        "scene: cloth.particles = 1.60008e+09: the product must be at most 2^24"},
       {withCloth("self_friction: -0.1"), "scene: cloth.self_friction = -0.1: must be >= 0"},
       {withCloth("size: [0.3, 0]"), "scene: cloth.size[1] = 0: must be > 0"},
       {withCloth("size: [0.3, 1e7]"), "scene: cloth.size[1] = 1e+07: must be at most 1e6"},
       {withCloth("size: [0.3, 1e5]"),
        "scene: cloth.size = 1315.7894736842106: the spacing of particles in m, must be at most 100000 times "
        "the "
        "fabric's "
        "thickness"},
       {ok + "stop: {time: 1e13}", "scene: stop.time = 1e+13: must be within 1e-12 to 1e12"},
       {ok + "solver: {time_step: 2}", "scene: solver.time_step = 2: must be at most 1"},
       {ok + "solver: {time_step: 1e-13}", "scene: solver.time_step = 1e-13: must be within 1e-12 to 1e12"},
       {ok + "air_damping: 1e13", "scene: air_damping = 1e+13: must be at most 1e12"},
       {ok + "probe: {path: [[1e13, 0, 0, 0]]}",
        "scene: probe.path[0][0] = 1e+13: must be within -1e12 to 1e12"},
       {withCloth("pins: [{particles: [[0, 77], [0, 0]]}]"),
        "scene: cloth.pins[0] = [0, 77]: particles[0] must be a range [first, last] with 0 <= first <= last "
        "<= 76"},
       {withCloth("pins: [corner_00, {particles: [[0, 0], [5, 3]]}]"),
        "scene: cloth.pins[1] = [5, 3]: particles[1] must be a range [first, last] with 0 <= first <= last "
        "<= 76"},
       {ok + "air_damping: -1", "scene: air_damping = -1: must be >= 0"},
       {ok + "adapt: {start: coarse}", "scene: adapt.start = coarse: must be one of finest, coarsest"},
       {ok + "adapt: {levels: 9}", "scene: adapt.levels = 9: must be in 0 to 8"},
       {ok + "adapt: {levels: -1}", "scene: adapt.levels = -1: must be in 0 to 8"},
       {ok + "adapt: {interval: 0}", "scene: adapt.interval = 0: must be >= 1"},
       {ok + "adapt: {minimum_age: -1}", "scene: adapt.minimum_age = -1: must be >= 0"},
       {ok + "adapt: {refine_above: 0.1, coarsen_below: 0.1}",
        "scene: adapt.coarsen_below = 0.1: must be below adapt.refine_above = 0.1"},
       {ok + "adapt: {coarsen_below_strain: 0.5}",
        "scene: adapt.coarsen_below_strain = 0.5: must be below adapt.refine_above_strain = 0.005"},
       {ok + "solver: {time_step: 0}", "scene: solver.time_step = 0: must be > 0"},
       {ok + "solver: {tolerance: -1}", "scene: solver.tolerance = -1: must be >= 0"},
       {ok + "solver: {max_iterations: 0}", "scene: solver.max_iterations = 0: must be >= 1"},
       {ok + "solver: {time_budget: -1}", "scene: solver.time_budget = -1: must be >= 0"},
       {ok + "solver: {threads: -1}", "scene: solver.threads = -1: must be in 0 to 1024"},
       {ok + "probe: {radius: 0}", "scene: probe.radius = 0: must be > 0"},
       {ok + "probe: {friction: -1}", "scene: probe.friction = -1: must be >= 0"},
       {ok + "probe: {coupling_stiffness: -1}", "scene: probe.coupling_stiffness = -1: must be > 0"},
       {ok + "probe: {coupling_damping: -1}", "scene: probe.coupling_damping = -1: must be >= 0"},
       {ok + "probe: {path: [[0, 0, 0, 0], [0, 0, 0, 1]]}",
        "scene: probe.path[1][0] = 0: times must increase strictly from row to row"},
       {ok + "stop: {time: 0}", "scene: stop.time = 0: must be > 0"},
       {ok + "stop: {rest_speed: -1}", "scene: stop.rest_speed = -1: must be >= 0"},
       {ok + "obstacles: [{shape: box, size: [1, -1, 1]}]", "scene: obstacles[0].size[1] = -1: must be > 0"},
       {ok + "obstacles: [{shape: plane}, {shape: sphere, radius: 0}]",
        "scene: obstacles[1].radius = 0: must be > 0"},
       {ok + "obstacles: [{shape: capsule, radius: 1, length: -1}]",
        "scene: obstacles[0].length = -1: must be > 0"},
       {ok + "obstacles: [{shape: plane, friction: -0.1}]",
        "scene: obstacles[0].friction = -0.1: must be >= 0"}});
}

TEST(SceneOverrides, ReplaceAddAndReachIntoLists) {
  const std::string yaml = std::string(kCloth) + "obstacles: [{shape: sphere, radius: 1}]\n";
  const Scene scene = parse(yaml, {"cloth.particles=[9, 13]", "obstacles.0.radius=0.5", "adapt.levels=1",
                                   "adapt.levels=2", "obstacles[0].friction=0", "stop.time=1.0e-1"});
  EXPECT_EQ(scene.cloth.particles, (std::array<int, 2>{9, 13}));
  EXPECT_EQ(scene.obstacles[0].radius, 0.5);
  EXPECT_EQ(scene.obstacles[0].friction, 0.0);
  EXPECT_EQ(scene.adapt.levels, 2);
  EXPECT_EQ(scene.stop.time, 0.1);
}

TEST(SceneOverrides, WrongOnesAreNamed) {
  const std::vector<std::pair<std::string, std::string>> cases{
      {"air_damping", "--set: air_damping: must be KEY=VALUE"},
      {"=3", "--set: =3: must be KEY=VALUE"},
      {"", "--set: must be KEY=VALUE"},
      {"a..b=3", "--set: a..b=3: must be KEY=VALUE with KEY such as cloth.size or obstacles.0.radius"},
      {"air_damping=", "--set: air_damping=: must have a value behind the ="},
      {"air_damping=x", "--set: air_damping = x: must be a finite number"},
      {"air_damping=-1", "--set: air_damping = -1: must be >= 0"},
      {"cloth.partciles=3",
       "--set: cloth.partciles: unknown key; known here: particles, size, position, orientation, fabric, "
       "pins, self_contact, self_friction"},
      {"cloth.fabric.name=x", "--set: cloth.fabric.name=x: cloth.fabric = linear has no keys below it"},
      {"obstacles.1.radius=3",
       "--set: obstacles.1.radius=3: 1 must be an index below 1, the length of obstacles"},
      {"obstacles.x=3", "--set: obstacles.x=3: x must be an index below 1, the length of obstacles"},
      {"probe.path.0=[0, 0, 0, 1]",
       "--set: probe.path.0=[0, 0, 0, 1]: probe.path must be a list that has an element 0"},
      {"obstacles.0.radius=0", "--set: obstacles[0].radius = 0: must be > 0"},
      {"adapt.level.s=1",
       "--set: adapt.level: unknown key; known here: strategy, start, levels, interval, refine_above, "
       "coarsen_below, refine_above_strain, coarsen_below_strain, far_angle_factor, far_strain_factor, "
       "near_reach, near_load, minimum_age"}};
  const std::string yaml = std::string(kCloth) + "obstacles: [{shape: sphere, radius: 1}]\n";
  for (const auto& [assignment, expected] : cases) EXPECT_EQ(message(yaml, {assignment}), expected);
  EXPECT_EQ(message(yaml, {"stop.time=[1"}).find("--set: stop.time=[1: malformed YAML: "), 0U);
  // An unrelated override is not blamed.
  EXPECT_EQ(message("air_damping: -1\n" + yaml, {"stop.time=1"}), "scene: air_damping = -1: must be >= 0");
}

TEST(SceneFile, MessagesHaveTheLine) {
  const fs::path file =
      fs::temp_directory_path() / ("haptic_cloth_scene_" + std::to_string(getpid()) + ".yaml");
  const auto fails = [&](const std::string& text, const std::vector<std::string>& overrides = {}) {
    std::ofstream(file) << text;
    try {
      loadScene(file.string(), overrides);
    } catch (const InputError& error) {
      return std::string(error.what()).substr(file.parent_path().string().size() + 1);
    }
    return std::string();
  };
  const std::string name = file.filename().string();
  EXPECT_EQ(fails("cloth:\n  fabric: linear\n  size: [1, 0]\n"), name + ":3: cloth.size[1] = 0: must be > 0");
  EXPECT_EQ(fails("cloth:\n  fabric: linear\nadapt:\n  levels: x\n"),
            name + ":4: adapt.levels = x: must be an integer");
  EXPECT_EQ(fails("cloth:\n  fabric: linear\n  pin: []\n", {"stop.time=1"}).find(name + ":3: cloth.pin: "),
            0U);
  EXPECT_EQ(fails("cloth:\n  fabric: [\n").find(name + ":"), 0U);
  EXPECT_EQ(fails(""), name + ": is empty, must be a YAML mapping");
  EXPECT_EQ(fails("cloth: {fabric: linear}"), "");
  fs::remove(file);
  EXPECT_THROW(loadScene(file.string()), InputError);
  EXPECT_THROW(loadScene(fs::temp_directory_path().string()), InputError);
}

/// A fabric built in code meets the rules of fabric files.
TEST(ValidateScene, ChecksFabricsBuiltInCode) {
  Scene scene;
  Fabric& fabric = scene.cloth.fabric;
  fabric.areal_density = 0.1;
  fabric.thickness = 5e-4;
  fabric.tensile.fill(Curve::linear(1000.0));
  const Fabric good = fabric;
  const auto fails = [&](const auto& change) {
    fabric = good;
    change();
    try {
      validateScene(scene, "code");
    } catch (const InputError& error) {
      return std::string(error.what());
    }
    return std::string();
  };
  const double nan = std::numeric_limits<double>::quiet_NaN();
  EXPECT_EQ(fails([&] { fabric.areal_density = 200.0; }),
            "code: cloth.fabric.areal_density = 200: must be at most 10: it is in kg/m^2, not g/m^2");
  EXPECT_EQ(fails([&] { fabric.thickness = 0.5; }),
            "code: cloth.fabric.thickness = 0.5: must be at most 0.05: it is in m, not mm");
  EXPECT_EQ(fails([&] { fabric.twist_rigidity = nan; }),
            "code: cloth.fabric.twist_rigidity = nan: must be >= 0 and at most 1e12");
  EXPECT_EQ(fails([&] { fabric.tensile[1] = Curve::linear(-100.0); }),
            "code: cloth.fabric.tensile[1] = -100: the stiffness must not be negative, as it is from 0 on");
  EXPECT_EQ(fails([&] { fabric.tensile[1] = Loop(); }),
            "code: cloth.fabric.tensile[1] = 0: must resist extension: its last force must be > 0");
  EXPECT_EQ(fails([&] {
              fabric.bending[0] = Curve(-1.0, 1.0, {-1.0, 0.0, -0.5});
            }),
            "code: cloth.fabric.bending[0] = -0.5: the stiffness must not be negative, as it is from 0 on");
  EXPECT_EQ(fails([&] {
              fabric.shear = Loop(-1.0, 1.0, {0.0, 1.0, 2.0}, {-1.0, -2.0, 1.0}, 5.0);
            }),
            "code: cloth.fabric.shear = -1: the stiffness must not be negative, as it is from -2 on");
  EXPECT_EQ(
      fails([&] {
        fabric.compression = Compression{5e-4, 5e-4, 0.3};
      }),
      "code: cloth.fabric.compression.pressed_thickness = 0.0005: must be > 0 and at most 0.99 thickness");
  EXPECT_EQ(fails([&] {
              fabric.compression = Compression{0.5, 0.4, 0.3};
            }),
            "code: cloth.fabric.compression.thickness = 0.5: must be within a factor of 10 of the fabric's "
            "thickness");
  EXPECT_EQ(fails([&] {
              fabric.compression = Compression{5e-4, 3e-4, 1.0};
            }),
            "code: cloth.fabric.compression.linearity = 1: must be >= 0.05 and < 1");
  EXPECT_EQ(fails([&] { fabric.compression = Compression{5e-4, 3e-4, 0.4}; }), "");
  for (const char* shipped : {"winter_suiting", "denim_a", "linear"}) {
    const std::string file = findFabric(shipped, "");
    EXPECT_EQ(fails([&] { fabric = loadFabric(file); }), "") << shipped;
  }
}

TEST(ValidateScene, ChecksWhatIsBuiltInCode) {
  Scene scene;
  scene.cloth.fabric.areal_density = 0.1;
  scene.cloth.fabric.thickness = 5e-4;
  scene.cloth.fabric.tensile.fill(Curve::linear(1000.0));
  EXPECT_NO_THROW(validateScene(scene, "code"));
  const double nan = std::numeric_limits<double>::quiet_NaN();
  const auto fails = [](const Scene& broken) {
    try {
      validateScene(broken, "code");
    } catch (const InputError& error) {
      return std::string(error.what());
    }
    return std::string();
  };
  EXPECT_EQ(fails(Scene()), "code: cloth.fabric.areal_density = 0: must be > 0");
  Scene broken = scene;
  broken.gravity.z() = nan;
  EXPECT_EQ(fails(broken), "code: gravity[2] = nan: must be >= -1e6");
  broken.gravity = Vec3(0, 0, -1e7);
  EXPECT_EQ(fails(broken), "code: gravity[2] = -1e+07: must be >= -1e6");
  broken = scene;
  broken.cloth.fabric.thickness = 0.0;
  EXPECT_EQ(fails(broken), "code: cloth.fabric.thickness = 0: must be > 0");
  broken = scene;
  broken.probes[0].radius = 1e-5;
  EXPECT_EQ(fails(broken),
            "code: probe.radius = 1e-05: must be at least 7.894736842105263e-05 m, a fiftieth of the finest "
            "spacing that cloth.size (in metres) and cloth.particles give");
  broken = scene;
  broken.probes[0].radius = 8.0;  // millimetres
  EXPECT_EQ(fails(broken),
            "code: probe.radius = 8: must be at most 3 m, ten times the longer side of cloth.size");
  broken = scene;
  broken.obstacles.emplace_back();
  broken.obstacles[0].shape = static_cast<Shape>(shapeNames().size());
  EXPECT_EQ(fails(broken), "code: obstacles[0].shape = 5: must be one of Shape");
  broken = scene;
  broken.stop.time = nan;
  EXPECT_EQ(fails(broken), "code: stop.time = nan: must be > 0");
  broken = scene;
  broken.cloth.pose.orientation.coeffs() *= 1.01;
  EXPECT_NE(fails(broken).find("code: cloth.orientation = "), std::string::npos);
  broken = scene;
  broken.probes[0].path = {{nan, Vec3::Zero()}};
  EXPECT_EQ(fails(broken), "code: probe.path[0][0] = nan: must be finite");
}

TEST(PathPosition, IsLinearBetweenRowsAndHeldOutside) {
  const std::vector<PathPoint> path{{1.0, Vec3(0, 0, 0)}, {2.0, Vec3(1, 2, 3)}, {4.0, Vec3(1, 2, 5)}};
  EXPECT_EQ(pathPosition(path, 0.0), Vec3(0, 0, 0));
  EXPECT_EQ(pathPosition(path, 1.5), Vec3(0.5, 1, 1.5));
  EXPECT_EQ(pathPosition(path, 2.0), Vec3(1, 2, 3));
  EXPECT_EQ(pathPosition(path, 3.0), Vec3(1, 2, 4));
  EXPECT_EQ(pathPosition(path, 9.0), Vec3(1, 2, 5));
}

TEST(ShippedScenes, AllLoad) {
  int count = 0;
  for (const char* folder : {"config", "bench"}) {
    for (const auto& entry :
         fs::recursive_directory_iterator(HAPTIC_CLOTH_SOURCE_DIR "/" + std::string(folder) + "/scenes")) {
      if (!entry.is_regular_file()) continue;
      SCOPED_TRACE(entry.path().string());
      EXPECT_NO_THROW(loadScene(entry.path().string()));
      ++count;
    }
  }
  EXPECT_GE(count, 7 + 14 + 9);
}

}  // namespace
}  // namespace haptic_cloth::scene_test
