/// Time integrator on one cell.
/// Criteria: BDF2 is exact for constant acceleration, both formulas solve m dv/dt = F - m c v in their own
/// terms (Hairer, Nørsett, Wanner: Solving ODEs I, III.1), and opposite forces keep momentum, all to
/// rounding.
#include "sim/time_integrator.h"

#include <gtest/gtest.h>

#include <cmath>
#include <utility>
#include <vector>

#include "sim/rigid_motion.h"
#include "support/tolerance.h"

namespace haptic_cloth::time_integrator_test {
namespace {

constexpr double kStep = 1e-3;       // [s]
constexpr double kRounding = 1e-12;  // of values near 1

/// Four free particles that all move alike, along x.
class Sheet {
 public:
  Sheet(Integrator kind, double air_damping) : integrator_(kind, kStep, air_damping, kGrid) {
    state_.position.assign(kGrid.particles(), Vec3::Zero());
    state_.velocity.assign(kGrid.particles(), Vec3::Zero());
    integrator_.prepare(state_);
    for (Field* field : {&positions_, &velocities_}) field->clear(mesh_.nodes());
    integrator_.gather(mesh_, state_);
  }

  /// Puts the sheet where it is after `step` steps of x(t), v(t), with what it keeps of the last one.
  template <class Position, class Velocity>
  void place(const Position& x, const Velocity& v, int step) {
    const double now = step * kStep, before = (step - 1) * kStep;
    move([](int) { return Vec3(Vec3::Zero()); });  // it knows a step
    for (int p = 0; p < kGrid.particles(); ++p) {
      state_.moved[p] = (x(now) - x(before)) * Vec3::UnitX();
      state_.gained[p] = (v(now) - v(before)) * Vec3::UnitX();
    }
    integrator_.gather(mesh_, state_);
    for (int n = 0; n < mesh_.nodes(); ++n) {
      positions_.set(n, x(now) * Vec3::UnitX());
      velocities_.set(n, v(now) * Vec3::UnitX());
    }
  }

  /// Makes a step in which a force over mass acts [m/s²].
  void step(double acceleration, double length = kStep) {
    step([=](int) { return acceleration; }, {0, 0, 0, 0}, length);
  }

  /// The same with a force of each node; those with a flag may touch something.
  template <class OfNode, class = decltype(std::declval<OfNode>()(0))>
  void step(const OfNode& acceleration, const std::vector<char>& touching, double length = kStep) {
    integrator_.begin(length);
    if (integrator_.secondOrder()) integrator_.expectJumps(touching);
    const TimeIntegrator& method = integrator_;
    move([&](int n) {
      return Vec3(method.inertialMotion(n, velocities_[n]) +
                  acceleration(n) / method.inertia(n) * Vec3::UnitX());
    });
  }

  /// Stops all nodes in one step, whatever inertia says.
  void block(bool foreseen) {
    integrator_.begin(kStep);
    integrator_.expectJumps(std::vector<char>(4, foreseen ? 1 : 0));
    move([](int) { return Vec3(Vec3::Zero()); });
  }

  /// Momentum that opposite forces do not change, for equal steps [kg m/s].
  double momentum() {
    integrator_.scatter(mesh_, state_);
    double sum = 0.0;
    for (int n = 0; n < mesh_.nodes(); ++n)
      sum += mesh_.mass[n] * (velocities_[n] + 0.5 * state_.gained[mesh_.particle[n]]).x();
    return sum;
  }
  double mass(int n) const { return mesh_.mass[n]; }

  double position() const { return positions_[3].x(); }
  double velocity() const { return velocities_[3].x(); }
  TimeIntegrator& integrator() { return integrator_; }
  Field& velocities() { return velocities_; }

  /// Multiplies what the sheet does as a rigid body, which is all that it does.
  void slow(double rigid) { integrator_.scale(mesh_, positions_, 0.7 * rigid, rigid, velocities_); }

 private:
  template <class Motion>
  void move(const Motion& motion) {
    Field end = positions_;
    for (int n = 0; n < mesh_.nodes(); ++n) end.add(n, motion(n));
    integrator_.finish(mesh_, positions_, end, velocities_);
    positions_ = end;
  }

  inline static const Grid kGrid{2, 2, 0, 0.01, 0.01};
  LeafMesh leaves_{kGrid, {}, 0};
  ActiveMesh mesh_{leaves_, 0.1};
  ParticleState state_;
  TimeIntegrator integrator_;
  Field positions_, velocities_;
};

TEST(TimeIntegrator, Bdf2IsExactForConstantAcceleration) {
  constexpr double kAcceleration = 3.0;
  const auto x = [](double t) { return 0.2 * t + 0.5 * kAcceleration * t * t; };
  const auto v = [](double t) { return 0.2 + kAcceleration * t; };
  Sheet sheet(Integrator::Bdf2, 0.0);
  sheet.place(x, v, 1);
  for (int k = 2; k <= 20; ++k) {
    sheet.step(kAcceleration);
    EXPECT_NEAR(sheet.position(), x(k * kStep), tolerance(kRounding));
    EXPECT_NEAR(sheet.velocity(), v(k * kStep), tolerance(kRounding));
  }
}

TEST(TimeIntegrator, Bdf2IsExactForConstantAccelerationWithAnyLengths) {
  constexpr double kAcceleration = 3.0;
  const auto x = [](double t) { return 0.2 * t + 0.5 * kAcceleration * t * t; };
  const auto v = [](double t) { return 0.2 + kAcceleration * t; };
  Sheet sheet(Integrator::Bdf2, 0.0);
  sheet.place(x, v, 1);
  int ticks = 1;
  for (const int length : {1, 2, 4, 4, 1, 8, 3, 1, 1}) {
    sheet.step(kAcceleration, length * kStep);
    ticks += length;
    EXPECT_NEAR(sheet.position(), x(ticks * kStep), tolerance(kRounding)) << ticks;
    EXPECT_NEAR(sheet.velocity(), v(ticks * kStep), tolerance(kRounding)) << ticks;
  }
}

TEST(TimeIntegrator, SolvesItsFormulaWithAir) {
  constexpr double kAir = 40.0, kForce = 5.0;
  Sheet euler(Integrator::Euler, kAir), bdf2(Integrator::Bdf2, kAir);
  double before = 0.0;
  for (int k = 0; k < 10; ++k) {
    const double now = euler.velocity();
    euler.step(kForce);
    EXPECT_NEAR((euler.velocity() - now) / kStep, kForce - kAir * euler.velocity(), tolerance(1e-9));
  }
  bdf2.step(kForce);  // the first step is one of backward Euler
  EXPECT_NEAR(bdf2.velocity(), kForce * kStep / (1.0 + kAir * kStep), tolerance(kRounding));
  for (int k = 0; k < 10; ++k) {
    const double now = bdf2.velocity();
    bdf2.step(kForce);
    const double derivative = (1.5 * bdf2.velocity() - 2.0 * now + 0.5 * before) / kStep;
    EXPECT_NEAR(derivative, kForce - kAir * bdf2.velocity(), tolerance(1e-9));
    before = now;
  }
}

TEST(TimeIntegrator, AForeseenBlowStopsAtOnce) {
  // Cloth that moves by u h in a step and is stopped in the next would be thrown back with u/2 by the formula
  // of BDF2.
  constexpr double kSpeed = 1.0;
  const auto x = [](double t) { return kSpeed * t; };
  const auto v = [](double) { return kSpeed; };
  Sheet smooth(Integrator::Bdf2, 0.0), stopped(Integrator::Bdf2, 0.0);
  for (Sheet* sheet : {&smooth, &stopped}) sheet->place(x, v, 5);
  smooth.block(false);
  EXPECT_NEAR(smooth.velocity(), -0.5 * kSpeed, tolerance(kRounding));
  stopped.block(true);
  EXPECT_EQ(stopped.velocity(), 0.0);
  stopped.step(0.0);
  EXPECT_EQ(stopped.velocity(), 0.0);
}

TEST(TimeIntegrator, OppositeForcesKeepMomentum) {
  // Nodes 0 and 1 pull at each other, and 1 and 2; now and then 1, 2 and 3 touch and press on each other.
  for (const std::vector<int>& lengths : {std::vector{1}, {1, 2}, {1, 2, 4, 2}, {1, 1, 1, 10}}) {
    Sheet sheet(Integrator::Bdf2, 0.0);
    sheet.step(3.0);
    const double before = sheet.momentum();
    for (int k = 0; k < 50; ++k) {
      const bool touch = k % 7 < 3;
      const double pull = 100.0 * std::sin(0.7 * k), press = touch ? 400.0 * std::cos(2.0 * k) : 0.0;
      const double force[] = {pull, press - 2.0 * pull, pull - 3.0 * press, 2.0 * press};
      const std::vector<char> touching{0, touch, touch, static_cast<char>(touch || k % 5 == 0)};
      const double length = lengths[k % lengths.size()] * kStep;
      sheet.step([&](int n) { return force[n] * sheet.mass(0) / sheet.mass(n); }, touching, length);
      EXPECT_NEAR(sheet.momentum(), before, tolerance(kRounding * 400.0 * kStep)) << k;
    }
  }
}

TEST(TimeIntegrator, SlowingScalesWhatIsKept) {
  const auto x = [](double t) { return t * t; };
  const auto v = [](double t) { return 2.0 * t; };
  const auto half_x = [&](double t) { return 0.5 * x(t); };
  const auto half_v = [&](double t) { return 0.5 * v(t); };
  Sheet slowed(Integrator::Bdf2, 0.0), slow(Integrator::Bdf2, 0.0);
  slowed.place(x, v, 3);
  slow.place(half_x, half_v, 3);
  const double ahead = slowed.position() - slow.position();
  slowed.slow(0.5);
  slowed.step(1.0);
  slow.step(1.0);
  EXPECT_NEAR(slowed.velocity(), slow.velocity(), tolerance(kRounding));
  EXPECT_NEAR(slowed.position() - slow.position(), ahead, tolerance(kRounding));
}

/// Free cloth in motion, on a mesh with hanging nodes, whose masses are on their masters.
struct FlyingCloth {
  Grid grid{9, 9, 1, 0.01, 0.02};
  ActiveMesh mesh{meshOf(grid)};
  TimeIntegrator integrator{Integrator::Bdf2, kStep, 0.0, grid};
  Field positions, velocities;

  FlyingCloth() {
    ParticleState state;
    state.position.resize(grid.particles());
    state.velocity.resize(grid.particles());
    integrator.prepare(state);
    integrator.gather(mesh, state);
    for (Field* field : {&positions, &velocities}) field->resize(mesh.nodes());
    for (int n = 0; n < mesh.nodes(); ++n) {
      const double i = grid.column(mesh.particle[n]), j = grid.row(mesh.particle[n]);
      positions.set(n, Vec3(grid.dx * i, grid.dy * j, 0.004 * std::sin(i + 2.0 * j)));
      velocities.set(n, Vec3(std::sin(3.0 * i), std::cos(j) + 2.0, 0.1 * i * j));
    }
    for (Field* field : {&positions, &velocities}) mesh.interpolateGhosts(*field);
  }

  static ActiveMesh meshOf(const Grid& grid) {
    LeafMesh leaves(grid, {}, 1);
    std::vector<Cell> split;
    leaves.split({2, 4, 1}, split);
    return ActiveMesh(leaves, 0.1);
  }

  Eigen::Matrix<double, 6, 1> momenta() const {
    Eigen::Matrix<double, 6, 1> sum = Eigen::Matrix<double, 6, 1>::Zero();
    for (int n = 0; n < mesh.nodes(); ++n) {
      sum.head<3>() += mesh.mass[n] * velocities[n];
      sum.tail<3>() += mesh.mass[n] * positions[n].cross(velocities[n]);
    }
    return sum;
  }

  template <class Speed>
  double energy(const Speed& velocity) const {
    double sum = 0.0;
    for (int n = 0; n < mesh.nodes(); ++n) sum += 0.5 * mesh.mass[n] * velocity(n).squaredNorm();
    return sum;
  }
  double energy() const {
    return energy([this](int n) { return velocities[n]; });
  }
  double rigidEnergy() const {
    const RigidMotion whole = rigidMotion(mesh, positions, velocities);
    return energy([&](int n) { return whole.at(positions[n]); });
  }
};

TEST(TimeIntegrator, SlowingLeavesMomentumAndSpin) {
  FlyingCloth cloth;
  const double rigid = cloth.rigidEnergy(), before = cloth.energy();
  const auto kept = cloth.momenta();
  cloth.integrator.scale(cloth.mesh, cloth.positions, 0.6, 1.0, cloth.velocities);
  EXPECT_LT((cloth.momenta() - kept).norm(), tolerance(kRounding) * kept.norm());
  EXPECT_NEAR(cloth.energy(), rigid + 0.36 * (before - rigid), tolerance(kRounding) * before);
  EXPECT_GT(before, 1.1 * rigid);
}

TEST(TimeIntegrator, APartOfAMotionLeavesMomentumAndSpin) {
  for (const double share : {1e-3, 0.25}) {
    FlyingCloth cloth;
    const double rigid = cloth.rigidEnergy(), before = cloth.energy();
    const auto kept = cloth.momenta();
    Field end = cloth.positions;
    for (int n = 0; n < end.size(); ++n) end.add(n, share * kStep * cloth.velocities[n]);
    cloth.integrator.begin(kStep);
    cloth.integrator.finishPart(cloth.mesh, cloth.positions, end, share, cloth.velocities);
    const double rounding =
        tolerance(1e-15 / kStep / share);  // of positions near 0.1 m, velocities near 1 m/s
    EXPECT_LT((cloth.momenta() - kept).norm(), rounding * kept.norm());
    EXPECT_NEAR(cloth.energy(), rigid + share * share * (before - rigid), 10.0 * rounding * before);
  }
}

TEST(TimeIntegrator, StoppedClothStays) {
  const auto x = [](double t) { return t; };
  const auto v = [](double) { return 1.0; };
  Sheet sheet(Integrator::Bdf2, 0.0);
  sheet.place(x, v, 3);
  const double where = sheet.position();
  sheet.integrator().stop(sheet.velocities());
  for (int k = 0; k < 3; ++k) sheet.step(0.0);
  EXPECT_EQ(sheet.position(), where);
  EXPECT_EQ(sheet.velocity(), 0.0);
}

}  // namespace
}  // namespace haptic_cloth::time_integrator_test
