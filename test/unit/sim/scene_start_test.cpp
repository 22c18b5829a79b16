/// Initial mesh of AMRC. Criterion: docs/reference/scenes.md.
#include <gtest/gtest.h>

#include <string>

#include "haptic_cloth/scene.h"
#include "haptic_cloth/simulation.h"

namespace haptic_cloth::scene_start_test {
namespace {

Scene parse(const std::string& adapt) {
  return parseScene("cloth: {fabric: linear}\nadapt: {" + adapt + "}\n", "scene", ".");
}

TEST(SceneStart, ArrivesAndIsTheFinestMeshIfNotSaid) {
  EXPECT_EQ(parse("strategy: amrc").adapt.start, StartMesh::Finest);
  EXPECT_EQ(parse("start: finest").adapt.start, StartMesh::Finest);
  EXPECT_EQ(parse("strategy: amrc, start: coarsest").adapt.start, StartMesh::Coarsest);
}

TEST(SceneStart, OtherStrategiesStartAsTheyMust) {
  for (const std::string strategy : {"finest", "coarsest", "refine", "coarsen"}) {
    const auto particles = [&](const std::string& start) {
      return Simulation(parse("start: " + start + ", strategy: " + strategy)).activeParticles();
    };
    EXPECT_EQ(particles("finest"), particles("coarsest")) << strategy;
  }
}

}  // namespace
}  // namespace haptic_cloth::scene_start_test
