/// The demonstration of self-contact: a hand takes a corner of the cloth, folds it over, presses the
/// fold, and starts again. Times are those of the cloth, so a slow machine only takes longer.
#include <gtest/gtest.h>
#include <haptic_cloth/ClothState.h>
#include <haptic_cloth/LoadState.h>
#include <haptic_cloth/SaveState.h>
#include <ros/ros.h>
#include <unistd.h>

#include <atomic>
#include <cmath>
#include <filesystem>
#include <mutex>

#include "haptic_cloth/simulation.h"
#include "haptic_cloth/state_file.h"
#include "ros/support/ros_test_support.h"

namespace haptic_cloth::fold_test {
namespace {

// From config/scenes/fold.yaml: times at which the hand holds the folded corner, presses the fold, has
// lifted, and the crease, where x + y is half of that of the corner's places before and after.
constexpr double kHeld = 3.6, kPressed = 5.4, kLifted = 9.3;      // s
constexpr double kCornerBefore = 0.20, kCornerAfter = -0.04;      // x + y, m
constexpr double kCrease = 0.5 * (kCornerBefore + kCornerAfter);  // m
/// Longest wait for a time of the cloth: a round takes 12.5 s at full speed.
constexpr double kRound = 100.0;  // s

/// Collects the node's messages about the cloth.
class ClothListener {
 public:
  explicit ClothListener(ros::NodeHandle& node)
      : subscriber_(node.subscribe("cloth/state", 1, &ClothListener::hear, this)) {}
  double time() const { return time_; }
  double corner() const { return corner_; }  ///< x + y of the corner that is folded [m]
  unsigned pairs() const { return pairs_; }
  double gap() const { return gap_; }  ///< [m]
  /// Waits until the cloth's time is between these [s].
  bool reaches(double from, double to) const {
    return waitFor([&] { return time_ >= from && time_ < to; }, kRound);
  }

 private:
  void hear(const ClothState::ConstPtr& state) {
    const std::uint32_t last = state->columns * state->rows - 1;
    for (std::size_t k = 0; k < state->particles.size(); ++k) {
      if (state->particles[k] == last) corner_ = state->positions[3 * k] + state->positions[3 * k + 1];
    }
    pairs_ = state->self_contacts;
    gap_ = state->min_self_gap;
    time_ = state->time;
  }
  std::atomic<double> time_{-1.0}, corner_{0.0}, gap_{0.0};
  std::atomic<unsigned> pairs_{0};
  ros::Subscriber subscriber_;  ///< last member: its callback uses all members above
};

TEST(Fold, ACornerIsFoldedOverPressedAndNeverPassesThrough) {
  ros::NodeHandle node;
  ros::AsyncSpinner spinner(2);
  spinner.start();
  ReactionListener reaction(node, "probe/reaction");
  DiagnosticsListener diagnostics(node);
  ClothListener cloth(node);
  std::atomic<double> largest{0.0};
  const ros::Subscriber forces = node.subscribe<geometry_msgs::WrenchStamped>(
      "probe/reaction", 1000, [&](const geometry_msgs::WrenchStamped::ConstPtr& message) {
        const auto& force = message->wrench.force;
        largest = std::max(largest.load(), Vec3(force.x, force.y, force.z).norm());
      });

  ASSERT_TRUE(cloth.reaches(0.0, 0.4)) << "the round does not start";
  EXPECT_GT(cloth.corner(), kCrease);
  ASSERT_TRUE(waitFor([&] { return diagnostics.value("probe", "grasp") == "holds cloth"; }, kRound))
      << "the corner was not taken";
  ASSERT_TRUE(cloth.reaches(kHeld, kLifted));
  EXPECT_LT(cloth.corner(), kCrease) << "the corner was not folded over";
  // The hand presses the layers together for a second and a half; pressing layers have a finite gap.
  ASSERT_TRUE(waitFor([&] { return cloth.time() > kPressed && cloth.pairs() > 0; }, kRound))
      << "no layers meet";
  EXPECT_TRUE(waitFor([&] { return std::isfinite(cloth.gap()); }, kRound));
  EXPECT_TRUE(waitFor([&] { return diagnostics.number("solver", "contacts between layers") > 0.0; }, kRound));
  EXPECT_EQ(diagnostics.value("solver", "self-contact"), "on");
  EXPECT_TRUE(waitFor([&] { return reaction.force().z() > 0.3; }, kRound)) << "the fold is not felt";

  // The node takes back only cloth that does not pass through itself; the check is repeated here.
  const std::string file =
      (std::filesystem::temp_directory_path() / ("haptic_cloth_fold_" + std::to_string(getpid()))).string();
  Simulation copy(loadScene(HAPTIC_CLOTH_SOURCE_DIR "/config/scenes/fold.yaml"));
  ASSERT_TRUE(waitFor(
      [&] {
        SaveState save;
        save.request.file = file;
        if (!cloth.reaches(kPressed, kLifted) || !ros::service::call("/haptic_cloth/save_state", save) ||
            !save.response.success) {
          return false;
        }
        copy.loadState(readStateFile(file, largestState(copy.scene())), file);
        return copy.time() >= kPressed;  // else the next round had begun
      },
      kRound));
  EXPECT_EQ(copy.crossings().pairs, 0);
  LoadState load;
  load.request.file = file;
  ASSERT_TRUE(ros::service::call("/haptic_cloth/load_state", load));
  EXPECT_TRUE(load.response.success) << load.response.message;
  std::filesystem::remove(file);

  ASSERT_TRUE(cloth.reaches(0.0, kHeld)) << "the hand does not start again";
  EXPECT_TRUE(reaction.finite());
  double limit = 0.0;
  ASSERT_TRUE(node.getParam("/haptic_cloth/haptics/max_force", limit));
  EXPECT_LE(largest, limit * (1.0 + 1e-12)) << "rounding of the norm";
  EXPECT_GE(diagnostics.number("solver", "failed: parts may have met"), 0.0) << "counted";
}

}  // namespace
}  // namespace haptic_cloth::fold_test

int main(int argc, char** argv) {
  testing::InitGoogleTest(&argc, argv);
  ros::init(argc, argv, "ros_fold_test");
  return RUN_ALL_TESTS();
}
