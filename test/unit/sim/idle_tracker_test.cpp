/// Steps that are skipped. Criterion: src/sim/idle_tracker.h.
#include "sim/idle_tracker.h"

#include <gtest/gtest.h>

#include <cmath>
#include <limits>

#include "support/scenes.h"

namespace haptic_cloth::idle_tracker_test {
namespace {

TEST(IdleTrackerTest, IsSavedAndLoadedAfterAFailedStep) {
  Scene scene;
  scene.probes.clear();
  const Probes probes(scene);
  IdleTracker tracker(0), other(0);
  StepReport report;
  report.minimizer.residual = 0.25;
  tracker.note(report, probes, 1e-3, 0);
  report.self_contacts = 7;
  report.max_penetration = 0.125;
  report.min_self_gap = 0.5;
  report.failed = true;
  report.minimizer.residual = std::numeric_limits<double>::quiet_NaN();  // as of a step that is not finite
  tracker.note(report, probes, 1e-3, 0);
  Archive saving;
  tracker.serialize(saving);
  Archive loading(saving.sealed(), "state");
  other.serialize(loading);
  loading.finish();
  EXPECT_EQ(other.skipped().minimizer.residual, 0.25);
  EXPECT_EQ(other.skipped().self_contacts, 7);
  EXPECT_EQ(other.skipped().max_penetration, 0.125);
  EXPECT_EQ(other.skipped().min_self_gap, 0.5);
}

TEST(IdleTrackerTest, KeepsThatNoLayersAreNear) {
  IdleTracker tracker(0), other(0);
  Archive saving;
  tracker.serialize(saving);
  Archive loading(saving.sealed(), "state");
  other.serialize(loading);
  EXPECT_TRUE(std::isinf(other.skipped().min_self_gap));
}

/// A flat sheet at rest, where cells merge late. Criterion: it ends as coarse as one that merges at once.
TEST(IdleTrackerTest, StepsAreNotSkippedBeforeTheMeshIsCoarse) {
  const auto activeAfter = [](int minimum_age) {
    Scene scene = sheetScene(makeFabric(LinearFabric()), 9, 9, 0.08, 0.08);
    setStrategy(scene, Strategy::Amrc, 2);
    scene.adapt.minimum_age = minimum_age;
    scene.gravity.setZero();
    Simulation simulation(scene);
    for (int step = 0; step < 600; ++step) simulation.step();
    return simulation.activeParticles();
  };
  EXPECT_EQ(activeAfter(200), activeAfter(AdaptOptions().minimum_age));
}

}  // namespace
}  // namespace haptic_cloth::idle_tracker_test
