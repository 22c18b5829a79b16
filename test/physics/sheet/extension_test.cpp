/// Sheets stretched along warp, along weft and on the bias, and sheared.
///
/// Criteria: extension w L²/2E and deflection w L²/2G of a sheet held by one side under its own
/// weight; the stiffness of an orthotropic sheet off its axes, 1/E_θ = c⁴/E1 + s⁴/E2 + (1/G -
/// 2ν/E1) s²c² with ν = 0 (Jones, Mechanics of Composite Materials); the shear angle of a
/// pin-jointed net under bias extension, γ = 90° - 2 acos[(1 + δ/D)/√2] (Cao et al. 2008,
/// Composites A 39).
#include <gtest/gtest.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <string>
#include <vector>

#include "energy/internal_energy.h"
#include "support/record.h"
#include "support/scenes.h"
#include "support/tolerance.h"

namespace haptic_cloth::extension_test {
namespace {

constexpr double kPi = 3.14159265358979323846;
constexpr double kDegree = kPi / 180.0;
constexpr double kWeight = 0.15 * 9.81;  // [N/m²]

class InPlane : public testing::TestWithParam<Strategy> {
 protected:
  /// Square of 0.2 m with gravity in its plane, held along i = 0 or j = 0.
  Scene sheet(const Fabric& fabric, Direction held, Direction gravity) const {
    Scene scene = sheetScene(fabric, 17, 17, kSide, kSide);
    scene.gravity = 9.81 * (gravity == kWarp ? Vec3::UnitX() : Vec3::UnitY());
    held == kWarp ? pin(scene, 0, 0, 0, 16) : pin(scene, 0, 16, 0, 0);
    setStrategy(scene, GetParam(), 2);
    quasiStatic(scene, 20.0, 5e-3, 1e-6);
    return scene;
  }

  static void rest(Simulation& simulation) {
    const Settled settled = settle(simulation, 1e-6, 5.0);
    EXPECT_TRUE(settled.at_rest);
    EXPECT_EQ(settled.failed_steps, 0);
    EXPECT_EQ(settled.unconverged, 0) << "of " << settled.steps;
  }

  static constexpr double kSide = 0.2;  // [m]
};

TEST_P(InPlane, ExtendsAlongWarpAndWeft) {
  const std::array<double, 2> stiffness{40.0, 90.0};
  Fabric fabric = makeFabric({});
  for (const int d : {kWarp, kWeft}) fabric.tensile[d] = Curve::linear(stiffness[d]);
  for (const Direction d : {kWarp, kWeft}) {
    Simulation simulation(sheet(fabric, d, d));
    rest(simulation);
    // The midpoint rule is exact for a linear law, at every active particle and on any mesh.
    for (const int at : {8, 16}) {
      const double length = kSide * at / 16.0;
      const Vec3 p = d == kWarp ? particle(simulation, at, 8) : particle(simulation, 8, at);
      const double extension = p[d] + 0.5 * kSide - length;
      const double exact = kWeight * length * (kSide - 0.5 * length) / stiffness[d];
      record({std::string("sheet hung up along ") + (d == kWarp ? "warp" : "weft"), "extension [m]",
              name(GetParam()), length, extension, exact, exact});
      EXPECT_NEAR(extension, exact, tolerance(1e-4 * exact));
    }
    EXPECT_NEAR(simulation.supportForce()[d], -simulation.mass() * 9.81,
                tolerance(1e-4 * simulation.mass() * 9.81));
  }
}

TEST_P(InPlane, ShearsUnderItsWeight) {
  // Held along one side, with a quarter of gravity along that side. The threads across cannot
  // stretch, so all particles of a column move alike: G v'' = -w. With finite stiffness the
  // shear-free borders yield in a layer of √(G/E) = 0.5 % of the side.
  LinearFabric linear;
  linear.shear_modulus = 5.0;
  linear.stiffness = 2e5;
  const Fabric fabric = makeFabric(linear);
  const double share = 0.25, exact = share * kWeight * kSide * kSide / (2.0 * linear.shear_modulus);
  for (const Direction held : {kWarp, kWeft}) {
    const Direction other = held == kWarp ? kWeft : kWarp;
    Scene scene = sheet(fabric, held, other);
    scene.gravity *= share;
    Simulation simulation(scene);
    rest(simulation);
    const Vec3 middle = held == kWarp ? particle(simulation, 16, 8) : particle(simulation, 8, 16);
    record({std::string("sheet sheared by its weight, held by ") + (held == kWarp ? "weft" : "warp"),
            "deflection [m]", name(GetParam()), 0.0, middle[other], exact, exact});
    EXPECT_NEAR(middle[other], exact, tolerance(2e-3 * exact));
  }
}

INSTANTIATE_TEST_SUITE_P(Strategies, InPlane,
                         testing::Values(Strategy::Finest, Strategy::Amrc, Strategy::Coarsest),
                         [](const auto& info) { return name(info.param); });

enum class Leaves { Finest, Coarsest, Mixed };

LeafMesh leavesOf(const Grid& grid, Leaves kind) {
  LeafMesh leaves(grid, {}, kind == Leaves::Finest ? 0 : grid.levels);
  std::vector<Cell> done;
  if (kind == Leaves::Mixed) {  // finest in the middle, so that cell sides change level somewhere
    while (leaves.leafAt(8, 8).level > 0) leaves.split(leaves.leafAt(8, 8), done);
  }
  return leaves;
}

std::string name(Leaves kind) {
  return kind == Leaves::Finest ? "finest" : kind == Leaves::Coarsest ? "coarsest" : "mixed";
}

/// Patch of cloth with an even deformation: warp threads become `warp`, weft threads `weft`.
class Patchwork {
 public:
  Patchwork(const Fabric& fabric, Leaves kind)
      : grid_{17, 17, 2, 0.01, 0.02},
        leaves_(leavesOf(grid_, kind)),
        mesh_(leaves_, fabric.areal_density),
        internal_(fabric, mesh_) {}

  double area() const { return 16 * grid_.dx * 16 * grid_.dy; }

  InternalEnergy::Energy energy(const Vec3& warp, const Vec3& weft) {
    const Field x = place(warp, weft);
    internal_.setNormals(x);
    return internal_.evaluate(0, internal_.size(), x);
  }

  /// Largest force on a particle inside the border [N].
  double largestInnerForce(const Vec3& warp, const Vec3& weft) {
    energy(warp, weft);
    Field gradient;
    gradient.clear(mesh_.nodes());
    internal_.addGradient(0, mesh_.nodes(), gradient);
    mesh_.handOverGhosts(gradient);
    double largest = 0.0;
    for (int n = 0; n < mesh_.active(); ++n) {
      const int i = grid_.column(mesh_.particle[n]), j = grid_.row(mesh_.particle[n]);
      if (i > 0 && j > 0 && i < 16 && j < 16) largest = std::max(largest, Vec3(gradient[n]).norm());
    }
    return largest;
  }

 private:
  Field place(const Vec3& warp, const Vec3& weft) const {
    std::vector<Vec3> x;
    for (int n = 0; n < mesh_.nodes(); ++n) {
      x.push_back(grid_.column(mesh_.particle[n]) * grid_.dx * warp +
                  grid_.row(mesh_.particle[n]) * grid_.dy * weft);
    }
    return Field(x);
  }

  Grid grid_;
  LeafMesh leaves_;
  ActiveMesh mesh_;
  InternalEnergy internal_;
};

class OffAxis : public testing::TestWithParam<std::tuple<Leaves, double>> {
 protected:
  static constexpr double kStiffness = 1000.0, kShear = 50.0;  // [N/m]

  static Fabric fabric() {
    LinearFabric linear;
    linear.stiffness = kStiffness;
    linear.shear_modulus = kShear;
    return makeFabric(linear);
  }

  /// Threads of a patch with a strain (along, across, shear) in axes turned by `angle` from warp.
  static std::array<Vec3, 2> threads(double angle, const std::array<double, 3>& strain) {
    const Vec3 a(std::cos(angle), std::sin(angle), 0.0), b(-std::sin(angle), std::cos(angle), 0.0);
    const Eigen::Matrix3d gradient = Eigen::Matrix3d::Identity() + strain[0] * a * a.transpose() +
                                     strain[1] * b * b.transpose() +
                                     strain[2] * (a * b.transpose() + b * a.transpose());
    return {gradient.col(0), gradient.col(1)};
  }
};

/// Minimum of a quadratic function of (y1, y2), from values one step apart: Newton on exact
/// differences.
template <class Function>
std::array<double, 2> minimumOfQuadratic(Function f, double step) {
  const double c = f(0.0, 0.0), px = f(step, 0.0), mx = f(-step, 0.0), py = f(0.0, step), my = f(0.0, -step);
  const double gx = 0.5 * (px - mx), gy = 0.5 * (py - my);
  const double hx = px - 2.0 * c + mx, hy = py - 2.0 * c + my;
  const double hxy = f(step, step) - px - py + c;
  const double det = hx * hy - hxy * hxy;
  return {step * (hxy * gy - hy * gx) / det, step * (hxy * gx - hx * gy) / det};
}

TEST_P(OffAxis, HasTheStiffnessOfAnOrthotropicSheet) {
  // Stretched at an angle to the threads, free to contract and to shear. The minimum of the energy
  // over these two is ½ E_θ ε² A. Strains of 1e-5 follow linear theory to 1e-4.
  const auto [kind, degrees] = GetParam();
  Patchwork patch(fabric(), kind);
  const double angle = degrees * kDegree, strain = 1e-5;
  const auto energy = [&](double across, double shear) {
    const std::array<Vec3, 2> t = threads(angle, {strain, across, shear});
    const InternalEnergy::Energy e = patch.energy(t[0], t[1]);
    return e.stretch + e.shear;
  };
  const std::array<double, 2> free = minimumOfQuadratic(energy, strain);
  const double stiffness = 2.0 * energy(free[0], free[1]) / (strain * strain * patch.area());
  const double c2 = std::pow(std::cos(angle), 2), s2 = std::pow(std::sin(angle), 2);
  const double exact = 1.0 / (c2 * c2 / kStiffness + s2 * s2 / kStiffness + s2 * c2 / kShear);
  record({"stretch off the axes", "stiffness [N/m]", name(kind), degrees, stiffness, exact, exact});
  EXPECT_NEAR(stiffness, exact, tolerance(1e-3 * exact));
  // The stress is even, so only the border carries a force, hanging nodes included.
  const std::array<Vec3, 2> t = threads(angle, {strain, free[0], free[1]});
  EXPECT_LT(patch.largestInnerForce(t[0], t[1]), tolerance(1e-7 * stiffness * strain * 0.01));
}

constexpr Leaves kLeaves[] = {Leaves::Finest, Leaves::Coarsest, Leaves::Mixed};

INSTANTIATE_TEST_SUITE_P(Meshes, OffAxis,
                         testing::Combine(testing::ValuesIn(kLeaves),
                                          testing::Values(0.0, 15.0, 30.0, 45.0, 70.0)),
                         [](const auto& info) {
                           return name(std::get<0>(info.param)) + "_" +
                                  std::to_string(std::lround(std::get<1>(info.param)));
                         });

/// Shear angle of a pin-jointed net whose diagonal is longer by `extension`.
double trellisAngle(double extension) {
  return 0.5 * kPi - 2.0 * std::acos((1.0 + extension) / std::sqrt(2.0));
}

TEST(Trellis, AngleIsThatOfTheLiterature) {
  EXPECT_NEAR(trellisAngle(0.05) / kDegree, 5.8831, tolerance(6e-5));
  EXPECT_NEAR(trellisAngle(0.10) / kDegree, 12.1224, tolerance(6e-5));
}

class TrellisMesh : public testing::TestWithParam<Leaves> {};

TEST_P(TrellisMesh, ShearsWithoutStretch) {
  LinearFabric linear;
  linear.shear_modulus = 50.0;
  Patchwork patch(makeFabric(linear), GetParam());
  for (const double extension : {0.05, 0.10}) {
    // The sides keep their length; one diagonal is d (1 + extension), the other follows by
    // Pythagoras.
    const double half = std::sqrt(0.5) * (1.0 + extension), across = std::sqrt(1.0 - half * half);
    const Vec3 warp(half, -across, 0.0), weft(half, across, 0.0);
    const InternalEnergy::Energy e = patch.energy(warp, weft);
    EXPECT_NEAR(e.stretch, 0.0, tolerance(1e-20));
    const double angle = std::sqrt(2.0 * e.shear / (linear.shear_modulus * patch.area()));
    const double exact = trellisAngle(extension);
    record({"bias extension of a pin-jointed net", "shear angle [rad]", name(GetParam()), extension, angle,
            exact, exact});
    EXPECT_NEAR(angle, exact, tolerance(1e-9));
  }
}

INSTANTIATE_TEST_SUITE_P(Meshes, TrellisMesh, testing::ValuesIn(kLeaves),
                         [](const auto& info) { return name(info.param); });

TEST_P(InPlane, FreeSheetOfShearedThreadsIsATrellis) {
  // The threads of this fabric are at rest at the angle of a net extended by 10 %. Cut square, it
  // moves to that net by itself: threads keep their length, the diagonal becomes 10 % longer.
  LinearFabric linear;
  linear.stiffness = 200.0;
  const double extension = 0.1, modulus = 20.0;
  Fabric fabric = makeFabric(linear);
  const double angle = trellisAngle(extension);
  fabric.shear = Curve(-1.0, 2.0, {modulus * (-1.0 - angle), modulus * (1.0 - angle)});
  Scene scene = sheetScene(fabric, 17, 17, kSide, kSide);
  scene.gravity = Vec3::Zero();
  pin(scene, 0, 0, 0, 0);
  setStrategy(scene, GetParam(), 2);
  quasiStatic(scene, 20.0, 5e-3, 1e-6);
  Simulation simulation(scene);
  rest(simulation);
  const double diagonal = (particle(simulation, 16, 16) - particle(simulation, 0, 0)).norm();
  const double value = diagonal / (kSide * std::sqrt(2.0)) - 1.0;
  record({"free sheet at rest in shear", "extension of the diagonal", name(GetParam()), 0.0, value, extension,
          extension});
  EXPECT_NEAR(value, extension, tolerance(1e-4 * extension));
  EXPECT_LT(simulation.maxStrain(), tolerance(1e-5));
}

}  // namespace
}  // namespace haptic_cloth::extension_test
