/// Turning angle of cells: compression, its memory, and pull round a solid.
/// Criteria: the formulas of docs/model.md (The adaptive mesh). A sheet with linear fabric that is
/// squeezed by ε carries k ε along its threads. Its turning angle is `refine_above` times k ε over
/// 2 (π² B/l² + 0.1 ρ g l), at the first look. Once the sheet is flat again, the angle falls with a time
/// constant of 70 ms (docs/decisions/0032). The load agrees to 1e-6, as exactly as the table of a law
/// gives its slope; the rest agrees to rounding. A curved sheet turns by κ l, or by twice that if its tension
/// times κ is more than 2 ρ g.
#include <gtest/gtest.h>

#include <cmath>
#include <limits>

#include "sim/cloth_world.h"
#include "support/scenes.h"
#include "support/tolerance.h"

namespace haptic_cloth {
namespace {

TEST(TurnEstimate, CompressionRisesAtOnceAndFallsSlowly) {
  constexpr int kSide = 5;
  constexpr double kSize = 0.1, kSqueezed = 1e-3;
  LinearFabric linear;
  linear.rigidity = 1e-5;
  Scene scene = sheetScene(makeFabric(linear), kSide, kSide, kSize, kSize);
  setStrategy(scene, Strategy::Amrc, 2);
  scene.gravity = Vec3::Zero();
  ClothWorld world(scene);
  TurnEstimate turns(scene.cloth.fabric, world.cloth().grid(), scene.gravity);

  const Cell parent{0, 0, 1};
  const auto turnWhenSqueezed = [&](double squeezed) {
    const TurnEstimate::View flat = world.turnView();
    Field nodes = flat.nodes;
    for (int n = 0; n < flat.mesh.nodes(); ++n) {
      const Vec3 x = flat.nodes[n];
      nodes.set(n, Vec3((1.0 - squeezed) * x.x(), x.y(), x.z()));
    }
    const TurnEstimate::View view{flat.mesh,   flat.internal,  flat.contacts, nodes,          flat.velocities,
                                  flat.weight, flat.look_time, flat.touches,  flat.split_turn};
    turns.begin(view, 0.0);
    return turns.turn(view, parent, 2, std::numeric_limits<double>::infinity());
  };

  const double length = 2.0 * kSize / (kSide - 1);
  const double bears = EIGEN_PI * EIGEN_PI * linear.rigidity / (length * length) +
                       0.1 * linear.areal_density * 9.80665 * length;
  const double full = scene.adapt.refine_above * linear.stiffness * kSqueezed / (2.0 * bears);
  const double look_time = scene.adapt.interval * scene.solver.time_step;
  EXPECT_NEAR(turnWhenSqueezed(0.0), 0.0, tolerance(1e-9) * full);
  const double first = turnWhenSqueezed(kSqueezed);
  EXPECT_NEAR(first, full, tolerance(1e-6) * full);
  for (int look = 1; look <= 50; ++look) {
    EXPECT_NEAR(turnWhenSqueezed(0.0), first * std::exp(-look * look_time / 0.07), tolerance(1e-9) * full)
        << look;
  }
  EXPECT_NEAR(turnWhenSqueezed(kSqueezed), first, tolerance(1e-9) * full);
}

TEST(TurnEstimate, CountsTwiceWhereClothIsPulledRoundASolid) {
  // A parabola of curvature κ; its slopes add less than 0.4 N/m to the tension, 13 % of the limit 2 ρ g/κ.
  constexpr int kSide = 5;
  constexpr double kSize = 0.1, kCurvature = 1.0;
  LinearFabric linear;
  linear.rigidity = 1e-5;
  Scene scene = sheetScene(makeFabric(linear), kSide, kSide, kSize, kSize);
  setStrategy(scene, Strategy::Amrc, 2);
  scene.gravity = Vec3::Zero();
  ClothWorld world(scene);
  const auto turnUnder = [&](double tension) {
    TurnEstimate turns(scene.cloth.fabric, world.cloth().grid(), scene.gravity);
    const TurnEstimate::View flat = world.turnView();
    Field nodes = flat.nodes;
    for (int n = 0; n < flat.mesh.nodes(); ++n) {
      const Vec3 x = flat.nodes[n];
      nodes.set(n, Vec3((1.0 + tension / linear.stiffness) * x.x(), x.y(), 0.5 * kCurvature * x.x() * x.x()));
    }
    const TurnEstimate::View view{flat.mesh,   flat.internal,  flat.contacts, nodes,          flat.velocities,
                                  flat.weight, flat.look_time, flat.touches,  flat.split_turn};
    turns.begin(view, 0.0);
    return turns.turn(view, Cell{0, 0, 1}, 2, std::numeric_limits<double>::infinity());
  };
  const double limit = 2.0 * linear.areal_density * 9.80665 / kCurvature;  // of tension [N/m]
  const double turn = kCurvature * 2.0 * kSize / (kSide - 1);
  EXPECT_NEAR(turnUnder(0.8 * limit), turn, tolerance(1e-9));
  EXPECT_NEAR(turnUnder(1.05 * limit), 2.0 * turn, tolerance(1e-9));
}

}  // namespace
}  // namespace haptic_cloth
