/// Turning angle of cells: compression, its memory, and pull round a solid; and the load that they carry.
/// Criteria: the formulas of docs/model.md (The adaptive mesh). A sheet with linear fabric that is
/// squeezed by ε carries k ε along its threads. Its turning angle is `refine_above` times k ε over
/// 2 (π² B/l² + 0.1 ρ g l), at the first look. Once the sheet is flat again, the angle falls with a time
/// constant of 70 ms (docs/decisions/0032). The load agrees to 1e-6, as exactly as the table of a law
/// gives its slope; the rest agrees to rounding. A curved sheet turns by κ l, or by twice that if its tension
/// times κ is more than 2 ρ g. A pulled one carries (k ε - 3 ρ g w) l, w its width; a merge needs a quarter
/// of what a split needs.
#include <gtest/gtest.h>

#include <cmath>
#include <limits>
#include <vector>

#include "sim/cloth_world.h"
#include "support/scenes.h"
#include "support/tolerance.h"

namespace haptic_cloth::turn_estimate_test {
namespace {

/// Square weightless sheet of linear fabric, whose nodes a test puts where it likes.
class TurnOfASheet : public testing::Test {
 protected:
  static constexpr int kSide = 5;
  static constexpr double kSize = 0.1,
                          kLength = 2.0 * kSize / (kSide - 1);  ///< of the sheet, of a parent [m]

  TurnOfASheet()
      : linear_(linear()),
        scene_(scene(linear_)),
        world_(scene_),
        turns_(scene_.cloth.fabric, world_.cloth().grid(), scene_.gravity) {}

  /// Turning angle of the parent of four finest cells. @param place of a node, from its place in the flat
  /// sheet
  template <class Place>
  double turn(const Place& place) {
    return lookAt(place, {}, [&](const TurnEstimate::View& view) {
      return turns_.turn(view, kParent, 2, std::numeric_limits<double>::infinity());
    });
  }

  /// Tells whether that parent carries a share of the load that counts for splits (parts 1) or merges (parts
  /// 2).
  template <class Place>
  bool carries(const Place& place, const std::vector<TurnEstimate::Touch>& touches, int parts, double share) {
    return lookAt(place, touches, [&](const TurnEstimate::View& view) {
      return turns_.carries(view, kParent, parts, share);
    });
  }

  const LinearFabric linear_;
  const Scene scene_;

 private:
  static constexpr Cell kParent{0, 0, 1};

  template <class Place, class Look>
  auto lookAt(const Place& place, const std::vector<TurnEstimate::Touch>& touches, const Look& look) {
    const TurnEstimate::View flat = world_.turnView();
    Field nodes = flat.nodes;
    for (int n = 0; n < flat.mesh.nodes(); ++n) nodes.set(n, place(flat.nodes[n]));
    const TurnEstimate::View view{flat.mesh,   flat.internal,  flat.contacts, nodes,          flat.velocities,
                                  flat.weight, flat.look_time, touches,       flat.split_turn};
    turns_.begin(view, 0.0);
    return look(view);
  }

  static LinearFabric linear() {
    LinearFabric linear;
    linear.rigidity = 1e-5;
    return linear;
  }

  static Scene scene(const LinearFabric& linear) {
    Scene scene = sheetScene(makeFabric(linear), kSide, kSide, kSize, kSize);
    setStrategy(scene, Strategy::Amrc, 2);
    scene.gravity = Vec3::Zero();
    return scene;
  }

  ClothWorld world_;
  TurnEstimate turns_;
};

TEST_F(TurnOfASheet, CompressedRisesAtOnceAndFallsSlowly) {
  constexpr double kSqueezed = 1e-3;
  const auto turnWhenSqueezed = [&](double squeezed) {
    return turn([&](const Vec3& x) { return Vec3((1.0 - squeezed) * x.x(), x.y(), x.z()); });
  };
  const double bears = EIGEN_PI * EIGEN_PI * linear_.rigidity / (kLength * kLength) +
                       0.1 * linear_.areal_density * 9.80665 * kLength;
  const double full = scene_.adapt.refine_above * linear_.stiffness * kSqueezed / (2.0 * bears);
  const double look_time = scene_.adapt.interval * scene_.solver.time_step;
  EXPECT_NEAR(turnWhenSqueezed(0.0), 0.0, tolerance(1e-9) * full);
  const double first = turnWhenSqueezed(kSqueezed);
  EXPECT_NEAR(first, full, tolerance(1e-6) * full);
  for (int look = 1; look <= 50; ++look) {
    EXPECT_NEAR(turnWhenSqueezed(0.0), first * std::exp(-look * look_time / 0.07), tolerance(1e-9) * full)
        << look;
  }
  EXPECT_NEAR(turnWhenSqueezed(kSqueezed), first, tolerance(1e-9) * full);
}

TEST_F(TurnOfASheet, PulledRoundASolidCountsTwice) {
  // A parabola of curvature κ; its slopes add less than 0.4 N/m to the tension, 13 % of the limit 2 ρ g/κ.
  constexpr double kCurvature = 1.0;
  const auto turnUnder = [&](double tension) {
    return turn([&](const Vec3& x) {
      return Vec3((1.0 + tension / linear_.stiffness) * x.x(), x.y(), 0.5 * kCurvature * x.x() * x.x());
    });
  };
  const double limit = 2.0 * linear_.areal_density * 9.80665 / kCurvature;  // of tension [N/m]
  EXPECT_NEAR(turnUnder(0.8 * limit), kCurvature * kLength, tolerance(1e-9));
  EXPECT_NEAR(turnUnder(1.05 * limit), 2.0 * kCurvature * kLength, tolerance(1e-9));
}

TEST_F(TurnOfASheet, CarriesItsTensionTimesItsLength) {
  constexpr double kStrain = 0.02, kForce = 0.5, kLess = 0.2;  // [-], [N], [N]
  const auto pulled = [&](const Vec3& x) { return Vec3((1.0 + kStrain) * x.x(), x.y(), x.z()); };
  const std::vector<TurnEstimate::Touch> touches{{Vec3::Zero(), 0.01, kLess}, {Vec3::Zero(), 0.01, kForce}};
  const double own = 3.0 * linear_.areal_density * 9.80665 * kSize,
               share = (linear_.stiffness * kStrain - own) * kLength / kForce;  // of the parent
  for (const auto& [parts, needed] : {std::pair{1, share}, std::pair{2, 4.0 * share}}) {
    EXPECT_TRUE(carries(pulled, touches, parts, needed * (1.0 - tolerance(1e-6))));
    EXPECT_FALSE(carries(pulled, touches, parts, needed * (1.0 + tolerance(1e-6))));
  }
  EXPECT_FALSE(carries(pulled, {}, 2, 1e-9)) << "no probe touches";
  const double little = 0.99 * own / linear_.stiffness;
  EXPECT_FALSE(
      carries([&](const Vec3& x) { return Vec3((1.0 + little) * x.x(), x.y(), x.z()); }, touches, 2, 0.0))
      << "no more than it may carry of its own";
}

}  // namespace
}  // namespace haptic_cloth::turn_estimate_test
