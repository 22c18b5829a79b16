/// Probes and moving obstacles in scene files. Criterion: docs/reference/scenes.md.
#include <gtest/gtest.h>

#include "haptic_cloth/error.h"
#include "haptic_cloth/scene.h"

namespace haptic_cloth::scene_probes_test {
namespace {

const std::string kCloth = "cloth: {fabric: linear}\n";

Scene parse(const std::string& yaml) { return parseScene(kCloth + yaml, "scene", "."); }

std::string message(const std::string& yaml) {
  try {
    parse(yaml);
  } catch (const InputError& error) {
    return error.what();
  }
  return "accepted";
}

TEST(SceneProbes, WithoutAWordThereIsOneSphere) {
  const Scene scene = parse("");
  ASSERT_EQ(scene.probes.size(), 1u);
  EXPECT_EQ(scene.probes[0].name, "probe");
  EXPECT_EQ(scene.probes[0].length, 0.0);
}

TEST(SceneProbes, ACoarseClothWithoutAProbeIsNotRefusedForIt) {
  // Particles are 2.5 m apart; a fiftieth of that is 50 mm, more than the default of 8 mm.
  const std::string coarse = "cloth: {fabric: linear, particles: [5, 5], size: [10, 10]}\n";
  const auto radius = [&](const std::string& rest) {
    return parseScene(coarse + rest, "scene", ".").probes[0].radius;
  };
  EXPECT_DOUBLE_EQ(radius(""), 0.05);
  EXPECT_DOUBLE_EQ(radius("probe: {coupling_stiffness: 800}"), 0.05) << "as a node keeps a live change";
  EXPECT_DOUBLE_EQ(radius("probe: {radius: 0.06}"), 0.06);
  EXPECT_EQ(parse("").probes[0].radius, ProbeOptions().radius);
  try {
    radius("probe: {radius: 0.008}");
    ADD_FAILURE() << "a radius that was asked for is judged";
  } catch (const InputError& error) {
    EXPECT_STREQ(
        error.what(),
        "scene: probe.radius = 0.008: must be at least 0.05 m, a fiftieth of the finest spacing that "
        "cloth.size (in metres) and cloth.particles give");
  }
}

TEST(SceneProbes, SeveralHaveNamesAndKeepTheirOrder) {
  const Scene scene = parse(
      "probes:\n"
      "  thumb: {radius: 0.01, friction: 0.5}\n"
      "  index: {shape: capsule, radius: 0.005, length: 0.03, orientation: [1, 0, 0, 0], path: [[0, 1, 2, "
      "3]],\n"
      "          grasp: [[0.5, 1.0], [2, 3]]}\n");
  ASSERT_EQ(scene.probes.size(), 2u);
  const ProbeOptions &thumb = scene.probes[0], &index = scene.probes[1];
  EXPECT_EQ(thumb.name, "thumb");
  EXPECT_EQ(thumb.radius, 0.01);
  EXPECT_EQ(thumb.friction, 0.5);
  EXPECT_EQ(thumb.length, 0.0);
  EXPECT_EQ(thumb.coupling_stiffness, ProbeOptions().coupling_stiffness);
  EXPECT_EQ(index.name, "index");
  EXPECT_EQ(index.length, 0.03);
  EXPECT_EQ(index.orientation.x(), 1.0);
  ASSERT_EQ(index.path.size(), 1u);
  EXPECT_EQ(index.path[0].position, Vec3(1, 2, 3));
  ASSERT_EQ(index.grasp.size(), 2u);
  EXPECT_EQ(index.grasp[1][0], 2.0);
}

TEST(SceneProbes, ProbeIsWhatSeveralHaveInCommon) {
  const Scene scene = parse("probe: {radius: 0.01}\nprobes: {a: {}, b: {radius: 0.02}}");
  ASSERT_EQ(scene.probes.size(), 2u);
  EXPECT_EQ(scene.probes[0].radius, 0.01);
  EXPECT_EQ(scene.probes[1].radius, 0.02);
}

/// What a probe gives itself replaces what it has in common with the others.
TEST(SceneProbes, EachKeyOfTheCommonPartCanBeReplaced) {
  const Scene scene = parse(
      "probe: {shape: capsule, length: 0.03, path: [[0, 0, 0, 1], [1, 0, 0, 1]], grasp: [[0, 1]]}\n"
      "probes: {a: {}, b: {shape: sphere}, c: {length: 0.02}, d: {shape: capsule}, e: {grasp: [[2, 3]]},\n"
      "  f: {grasp: []}}");
  const auto lengths = [&](std::size_t k) { return scene.probes[k].length; };
  EXPECT_EQ(lengths(0), 0.03);
  EXPECT_EQ(lengths(1), 0.0);
  EXPECT_EQ(lengths(2), 0.02);
  EXPECT_EQ(lengths(3), 0.03);
  ASSERT_EQ(scene.probes[4].grasp.size(), 1u);
  EXPECT_EQ(scene.probes[4].grasp[0][0], 2.0);
  EXPECT_TRUE(scene.probes[5].grasp.empty());
  EXPECT_EQ(message("probe: {shape: capsule, length: 0.03}\nprobes: {a: {shape: sphere, length: 0.02}}"),
            "scene: probes.a.length = 0.02: is for shape: capsule");
}

TEST(SceneProbes, WhatCannotBeIsNamed) {
  EXPECT_EQ(message("probes: {}"), "scene: probes = {}: must name at least one probe");
  EXPECT_EQ(message("probes: {1st: {}}"),
            "scene: probes = 1st: a name must be a letter, then letters, digits and underscores");
  EXPECT_EQ(message("probes: {a: {}, a: {}}"), "scene: probes.a: must not stand here twice");
  EXPECT_EQ(message("probe: {shape: capsule}"), "scene: probe.length: is required for this shape");
  EXPECT_EQ(message("probe: {length: 0.1}"), "scene: probe.length = 0.1: is for shape: capsule");
  EXPECT_EQ(message("probe: {shape: capsule, length: -0.1}"), "scene: probe.length = -0.1: must be >= 0");
  EXPECT_EQ(message("probes: {a: {radius: -1}}"), "scene: probes.a.radius = -1: must be > 0");
  EXPECT_EQ(message("probe: {grasp: [[1, 2]]}"),
            "scene: probe.grasp = 1 rows: needs a path: its times are those of the path");
  EXPECT_EQ(message("probe: {path: [[0, 0, 0, 0]], grasp: [[1, 1]]}"),
            "scene: probe.grasp[0] = 1: must be [from, to] with from < to");
}

TEST(SceneObstacles, HaveNamesAndPaths) {
  const Scene scene = parse("obstacles: [{shape: plane, name: floor, path: [[0, 0, 0, 0], [1, 0, 0, 0.1]]}]");
  ASSERT_EQ(scene.obstacles.size(), 1u);
  EXPECT_EQ(scene.obstacles[0].name, "floor");
  ASSERT_EQ(scene.obstacles[0].path.size(), 2u);
  EXPECT_EQ(scene.obstacles[0].path[1].position.z(), 0.1);
  EXPECT_EQ(message("obstacles: [{shape: plane, name: a}, {shape: plane, name: a}]"),
            "scene: obstacles = a: a name must not be used twice");
  EXPECT_EQ(message("obstacles: [{shape: plane, name: a/b}]"),
            "scene: obstacles = a/b: a name must be a letter, then letters, digits and underscores");
  EXPECT_EQ(message("obstacles: [{shape: plane, path: [[1, 0, 0, 0], [1, 0, 0, 1]]}]"),
            "scene: obstacles[0].path[1][0] = 1: times must increase strictly from row to row");
}

}  // namespace
}  // namespace haptic_cloth::scene_probes_test
