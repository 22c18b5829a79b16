/// Torque of the cloth on a probe about its proxy, from the contact samples.
/// Criterion: virtual work. Turning a frictionless probe by dθ about an axis through its proxy
/// changes the contact energy by -torque · axis dθ, so the torque is a difference quotient of the
/// energy. With dθ = 1e-6 the end of a capsule moves by 3e-8 m, 1e-3 of the gap over which the
/// pressure changes. The relative error of the quotient is that squared, 1e-6.
#include <gtest/gtest.h>

#include <cmath>

#include "contact/contact_set.h"
#include "support/scenes.h"
#include "support/tolerance.h"

namespace haptic_cloth::contact_torque_test {
namespace {

constexpr double kRange = 5e-4;    // gap at which contact begins [m]
constexpr double kSpacing = 4e-3;  // particle spacing [m]
constexpr int kSide = 13;
const Quat kLying = lyingAlong(Vec3(1.0, 0.4, 0.1));

struct Measured {
  double energy;  ///< [J]
  Vec3 force, torque;
};

/// Bent sheet, with a probe that presses on it from above.
class PressedSheet {
 public:
  explicit PressedSheet(double length)
      : grid_{kSide, kSide, 0, kSpacing, kSpacing}, leaves_(grid_, {}, 0), mesh_(leaves_, 0.15) {
    probe_.radius = 8e-3;
    probe_.length = length;
    probe_.friction = 0.0;
    for (Field* field : {&nodes_, &still_}) field->clear(mesh_.nodes());
    for (int n = 0; n < mesh_.nodes(); ++n) {
      const int p = mesh_.particle[n];
      const double x = kSpacing * (grid_.column(p) - 0.5 * (kSide - 1)),
                   y = kSpacing * (grid_.row(p) - 0.5 * (kSide - 1));
      nodes_.set(n, Vec3(x, y, 1.5 * x * x - y * y + 0.05 * x - 0.1 * y));
    }
  }

  Measured measure(const Vec3& proxy, const Quat& orientation) const {
    Team team(1);
    ContactSet contacts(grid_, {}, {probe_}, {kRange, 1e-3, 1e-3}, team);
    contacts.startProbe(0, proxy, orientation, orientation);
    contacts.collectProbes(mesh_, nodes_, std::vector<double>(mesh_.nodes(), 1e-3), still_, {{0, 1e-3}});
    contacts.collectObstacles(mesh_, nodes_, std::vector<double>(mesh_.nodes(), 1e-3), still_);
    const double energy = contacts.evaluate(0, contacts.size(), nodes_).solids;
    return {energy, -contacts.proxyGradient(0), contacts.proxyTorque(0, nodes_)};
  }

  /// Lowers the probe until its nearest sample is compressed by about 0.6 of the range.
  Vec3 pressed(const Quat& orientation) const {
    for (double height = 0.012;; height -= 2e-5) {
      const Vec3 proxy(3e-3, -2e-3, height);
      if (measure(proxy, orientation).force.z() > 0.2) return proxy;
    }
  }

 private:
  Grid grid_;
  LeafMesh leaves_;
  ActiveMesh mesh_;
  ProbeOptions probe_;
  Field nodes_, still_;
};

TEST(ContactTorque, IsWhatTurningTheCapsuleWorks) {
  constexpr double kTurn = 1e-6;  // [rad]
  const PressedSheet sheet(0.04);
  const Vec3 proxy = sheet.pressed(kLying);
  const Measured at = sheet.measure(proxy, kLying);
  ASSERT_GT(at.torque.norm(), 0.1 * 0.02 * at.force.norm()) << "pressed off its middle";
  for (int c = 0; c < 3; ++c) {
    const auto energy = [&](double turn) {
      return sheet.measure(proxy, Quat(Eigen::AngleAxisd(turn, Vec3::Unit(c))) * kLying).energy;
    };
    const double quotient = -(energy(kTurn) - energy(-kTurn)) / (2.0 * kTurn);
    EXPECT_NEAR(at.torque[c], quotient, tolerance(1e-6 * at.torque.norm())) << "axis " << c;
  }
}

/// The pressure on a sphere points through its centre. Rounding: 1e-16 of force times radius for
/// each of some hundred samples.
TEST(ContactTorque, OfASphereIsZero) {
  const PressedSheet sheet(0.0);
  const Vec3 proxy = sheet.pressed(Quat::Identity());
  const Measured at = sheet.measure(proxy, Quat::Identity());
  EXPECT_LT(at.torque.norm(), tolerance(1e-14 * at.force.norm() * 8e-3));
}

/// The torque of one load about two points differs by their distance times the force.
TEST(ContactTorque, IsAboutTheProxy) {
  // A capsule moved along its axis, with both ends off the cloth, touches it in the same place.
  const PressedSheet sheet(0.2);
  const Vec3 proxy = sheet.pressed(kLying), way = 0.01 * (kLying * Vec3::UnitZ());
  const Measured before = sheet.measure(proxy, kLying), after = sheet.measure(proxy + way, kLying);
  ASSERT_LT((after.force - before.force).norm(), 1e-9 * before.force.norm());
  const Vec3 expected = before.torque - way.cross(before.force);
  EXPECT_LT((after.torque - expected).norm(), tolerance(1e-9 * expected.norm()));
}

}  // namespace
}  // namespace haptic_cloth::contact_torque_test
