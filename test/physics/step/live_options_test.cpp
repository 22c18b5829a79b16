/// Options changed between two steps.
/// Criteria: changed before the first step they give the same bits as a scene that had them from
/// the start; changed under load they lead to the same equilibrium; a refused change alters no bit;
/// the energy balance holds over the change.
#include <gtest/gtest.h>

#include <algorithm>
#include <functional>
#include <limits>

#include "haptic_cloth/error.h"
#include "support/scenes.h"
#include "support/tolerance.h"

namespace haptic_cloth::live_options_test {
namespace {

constexpr double kNaN = std::numeric_limits<double>::quiet_NaN();

/// Sheet held on all sides below a probe, on an adaptive mesh.
Scene sheet() {
  LinearFabric linear;
  linear.stiffness = 1000.0;
  linear.rigidity = 1e-5;
  Scene scene = sheetScene(makeFabric(linear), 33, 33, 0.2, 0.2);
  setStrategy(scene, Strategy::Amrc, 2);
  pinAllSides(scene);
  scene.air_damping = 1.0;
  scene.probes[0].radius = 0.01;
  return scene;
}

/// Waits 60 steps above the cloth, presses 23 mm deep within 0.1 s and continues up to `steps`.
void press(Simulation& simulation, int steps) {
  for (int n = 0; n < steps; ++n) {
    const double way = std::clamp((n - 60) / 100.0, 0.0, 1.0);
    const Vec3 velocity(0.0, 0.0, way > 0.0 && way < 1.0 ? -0.25 : 0.0);
    simulation.setDevice(Vec3(0.0, 0.0, 0.012 - 0.025 * way), velocity);
    simulation.step();
  }
}

struct Change {
  const char* name;
  std::function<void(Scene&)> make;
  int steps = 180;
};

void PrintTo(const Change& change, std::ostream* out) { *out << change.name; }

void takeOver(Simulation& simulation, const Scene& scene) {
  simulation.setOptions(scene.solver, scene.adapt, scene.air_damping);
  simulation.setCoupling(0, scene.probes[0].coupling_stiffness, scene.probes[0].coupling_damping);
}

class LiveChange : public testing::TestWithParam<Change> {};

TEST_P(LiveChange, IsWhatASceneHasFromTheStart) {
  Scene other = sheet();
  GetParam().make(other);
  Simulation plain(sheet()), changed(sheet()), wanted(other);
  takeOver(changed, other);
  for (Simulation* simulation : {&plain, &changed, &wanted}) press(*simulation, GetParam().steps);
  EXPECT_EQ(changed.stateHash(), wanted.stateHash());
  EXPECT_NE(changed.stateHash(), plain.stateHash()) << "the change does nothing here";
  changed.reset();
  press(changed, GetParam().steps);
  EXPECT_EQ(changed.stateHash(), wanted.stateHash()) << "a reset keeps it";
}

INSTANTIATE_TEST_SUITE_P(
    All, LiveChange,
    testing::Values(Change{"tolerance", [](Scene& s) { s.solver.minimizer.tolerance = 0.01; }},
                    Change{"max_iterations", [](Scene& s) { s.solver.minimizer.max_iterations = 2; }},
                    Change{"sleep_speed", [](Scene& s) { s.solver.sleep_speed = 1.0; }, 500},
                    Change{"interval", [](Scene& s) { s.adapt.interval = 7; }},
                    Change{"bending",
                           [](Scene& s) {
                             s.adapt.refine_above = 0.1;
                             s.adapt.coarsen_below = 0.05;
                           }},
                    Change{"strain",
                           [](Scene& s) {
                             s.adapt.refine_above_strain = 1e-4;
                             s.adapt.coarsen_below_strain = 5e-5;
                           }},
                    Change{"far",
                           [](Scene& s) {
                             s.adapt.far_angle_factor = 8.0;
                             s.adapt.far_strain_factor = 50.0;
                             s.adapt.near_reach = 1.0;
                             s.adapt.near_load = 1.0;
                           }},
                    Change{"air_damping", [](Scene& s) { s.air_damping = 8.0; }},
                    Change{"coupling_stiffness", [](Scene& s) { s.probes[0].coupling_stiffness = 900.0; }},
                    Change{"coupling_damping", [](Scene& s) { s.probes[0].coupling_damping = 3.0; }}),
    [](const auto& info) { return std::string(info.param.name); });

TEST(LiveOptions, AnotherCouplingUnderLoadComesToItsOwnEquilibrium) {
  Scene scene = sheet();
  scene.solver.minimizer.tolerance = 0.01;
  scene.solver.sleep_speed = 0.0;
  scene.air_damping = 20.0;
  Scene stiffer = scene;
  stiffer.probes[0].coupling_stiffness = 2000.0;
  Simulation changed(scene), wanted(stiffer);
  press(changed, 600);
  const double before = changed.probe().force.z();
  double dissipated = changed.energy().dissipated, least = 0.0;
  for (int n = 0; n < 900; ++n) {
    const double share = std::min(1.0, n / 300.0);
    changed.setCoupling(0, 400.0 + share * 1600.0, 1.0);
    changed.setDevice(Vec3(0.0, 0.0, -0.013), Vec3::Zero());
    changed.step();
    least = std::min(least, changed.energy().dissipated - dissipated);
    dissipated = changed.energy().dissipated;
  }
  press(wanted, 1500);
  const double after = changed.probe().force.z();
  EXPECT_GT(after, 1.02 * before) << "a stiffer coupling presses harder";
  EXPECT_NEAR(after, wanted.probe().force.z(), tolerance(0.005 * after));
  // Energy that the change puts into the spring is work of the device and must not appear from
  // nowhere.
  EXPECT_GT(least, -1e-9);
}

std::string refusal(Simulation& simulation, const std::function<void(Scene&)>& make) {
  Scene scene = simulation.scene();
  make(scene);
  try {
    takeOver(simulation, scene);
  } catch (const InputError& error) {
    return error.what();
  }
  return "";
}

TEST(LiveOptions, WhatIsRefusedChangesNothing) {
  Simulation plain(sheet()), asked(sheet());
  const auto expect = [&](const std::string& part, const std::function<void(Scene&)>& make) {
    EXPECT_NE(refusal(asked, make).find(part), std::string::npos) << part << ": " << refusal(asked, make);
  };
  expect("solver.tolerance = nan: must be >= 0", [](Scene& s) { s.solver.minimizer.tolerance = kNaN; });
  expect("solver.max_iterations = 0: must be >= 1", [](Scene& s) { s.solver.minimizer.max_iterations = 0; });
  expect("air_damping = -1: must be >= 0", [](Scene& s) { s.air_damping = -1.0; });
  expect("adapt.coarsen_below = 0.8: must be below adapt.refine_above = 0.7", [](Scene& s) {
    s.adapt.coarsen_below = 0.8;
    s.solver.minimizer.tolerance = 0.5;  // valid by itself, but in the same set
  });
  expect("solver.time_step: cannot change", [](Scene& s) { s.solver.time_step = 2e-3; });
  expect("solver.integrator: cannot change", [](Scene& s) { s.solver.integrator = Integrator::Bdf2; });
  expect("solver.cost: cannot change", [](Scene& s) { s.solver.cost = Cost::Joint; });
  expect("solver.preconditioner: cannot change",
         [](Scene& s) { s.solver.minimizer.preconditioner = Preconditioner::None; });
  expect("solver.threads: cannot change", [](Scene& s) { s.solver.threads = 7; });
  expect("adapt.levels: cannot change", [](Scene& s) { s.adapt.levels = 1; });
  expect("adapt.strategy: cannot change", [](Scene& s) { s.adapt.strategy = Strategy::Finest; });
  EXPECT_THROW(asked.setCoupling(0, 0.0, 1.0), InputError);
  EXPECT_THROW(asked.setCoupling(0, kNaN, 1.0), InputError);
  EXPECT_THROW(asked.setCoupling(0, 2e12, 1.0), InputError);  // as in a scene
  EXPECT_THROW(asked.setCoupling(0, 400.0, -1.0), InputError);
  for (Simulation* simulation : {&plain, &asked}) press(*simulation, 120);
  EXPECT_EQ(asked.stateHash(), plain.stateHash());
}

}  // namespace
}  // namespace haptic_cloth::live_options_test
