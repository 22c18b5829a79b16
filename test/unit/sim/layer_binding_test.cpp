// Layers that press on each other in the preconditioner.
// Criterion: bound layers are inverted as one matrix, own blocks plus the Hessian of the pairs. So in the
// direction z = M⁻¹ g the quadratic form of M is z · g, to the rounding of a direct solve, which grows with
// the condition number (block_factor_test.cpp).
#include "sim/layer_binding.h"

#include <gtest/gtest.h>

#include <random>

#include "support/derivatives.h"
#include "support/folded_cloth.h"
#include "support/tolerance.h"

namespace haptic_cloth::layer_binding_test {
namespace {

constexpr double kOwn = 1e-3;  // so soft that all pairs are stiff beside it [N/m]

class LayerBindingTest : public testing::TestWithParam<bool> {
 protected:
  LayerBindingTest() : cloth_(gridOf(25, 9, 2), leaves(), 0.4) {
    std::mt19937 random(5);
    cloth_.place([](const Vec3& at) { return hairpin(at, 0.04, 0.5 * kThickness + 0.01 * at.y()); });
    shake(cloth_, random, 2e-5);
    cloth_.collect();
    shake(cloth_, random, 2e-6);  // slips, too
    cloth_.energy(cloth_.x);
  }
  static LeafMesh leaves() {
    const Grid grid = gridOf(25, 9, 2);
    return GetParam() ? mixedLeaves(grid, 2) : LeafMesh(grid, {}, 0);
  }

  /// z = P g of blocks `own` with the layers bound.
  Vector apply(const Vector& gradient, const BlockField& inverse) {
    Vector z = Vector::Zero(gradient.size());
    for (int n = 0; n < mesh_.free; ++n) {
      const Vec3 by_node = product(inverse[n], of(gradient, n));
      for (int c = 0; c < 3; ++c) z[c * mesh_.free + n] = by_node[c];
    }
    const Blocks own(mesh_.nodes(), isotropic(0.5 * kOwn));
    LayerBinding binding(mesh_);
    binding.fit(cloth_.contact, own, own, inverse, cloth_.x);
    binding.apply(inverse, gradient, z);
    return z;
  }
  /// Inverted blocks of the nodes alone, with the layers as springs.
  BlockField inverses() {
    Blocks springs(mesh_.nodes(), Block::Zero());
    cloth_.contact.addSprings(springs);
    mesh_.handOverGhosts(springs);
    BlockField result;
    result.resize(mesh_.free);
    for (int n = 0; n < mesh_.free; ++n) result.set(n, inverse(isotropic(kOwn) + springs[n]));
    return result;
  }
  /// Relative error of a factor and its solution: the condition number times four roundings for each unknown.
  double rounding() const {
    double stiffest = 0.0;
    cloth_.contact.forSprings(0.1, [&](const PairPoints&, int, const Block& spring) {
      stiffest = std::max(stiffest, spring.head<3>().sum());
    });
    return 4.0 * 3.0 * mesh_.free * 0x1p-52 * stiffest / kOwn;
  }
  Vec3 of(const Vector& v, int n) const { return {v[n], v[mesh_.free + n], v[2 * mesh_.free + n]}; }

  /// Quadratic form of own blocks and pairs along z.
  double formAlong(const Vector& z) {
    constexpr double kShort = 1e-12;  // friction as at the start of a direction
    Field d;
    d.clear(mesh_.nodes());
    for (int n = 0; n < mesh_.free; ++n) d.set(n, kShort * of(z, n));
    mesh_.interpolateGhosts(d);
    return kOwn * z.squaredNorm() +
           cloth_.contact.quadraticForm(0, cloth_.contact.size(), d) / (kShort * kShort);
  }

  Folded cloth_;
  const ActiveMesh& mesh_ = cloth_.mesh;
};

INSTANTIATE_TEST_SUITE_P(Meshes, LayerBindingTest, testing::Bool(),
                         [](const auto& info) { return std::string(info.param ? "mixed" : "finest"); });

TEST_P(LayerBindingTest, InvertsStiffLayersAsOneMatrix) {
  ASSERT_GT(cloth_.contact.touching(), 10);
  const BlockField inverse = inverses();
  for (unsigned seed = 1; seed <= 5; ++seed) {
    const Vector gradient = fixedRandom(3 * mesh_.free, seed), z = apply(gradient, inverse);
    const double work = z.dot(gradient);
    EXPECT_NEAR(formAlong(z), work, tolerance(rounding()) * work) << seed;
  }
}

/// Nodes that do not move are not bound, and the others as if they stood still.
TEST_P(LayerBindingTest, LeavesOutWhatDoesNotMove) {
  BlockField inverse = inverses();
  std::vector<int> fixed;
  for (int n = 0; n < mesh_.free; n += 3) {
    inverse.set(n, Block::Zero());
    fixed.push_back(n);
  }
  Vector gradient = fixedRandom(3 * mesh_.free, 9);
  for (const int n : fixed) {
    for (int c = 0; c < 3; ++c) gradient[c * mesh_.free + n] = 0.0;
  }
  const Vector z = apply(gradient, inverse);
  for (const int n : fixed) EXPECT_EQ(of(z, n), Vec3::Zero());
  EXPECT_NEAR(formAlong(z), z.dot(gradient), tolerance(rounding()) * z.dot(gradient));
}

TEST_P(LayerBindingTest, LeavesSoftPairsAtTheirNodes) {
  const Blocks stiff(mesh_.nodes(), isotropic(1e12));
  BlockField inverse;
  inverse.resize(mesh_.free);
  for (int n = 0; n < mesh_.free; ++n) inverse.set(n, isotropic(1e-12));
  LayerBinding binding(mesh_);
  binding.fit(cloth_.contact, stiff, stiff, inverse, cloth_.x);
  const Vector gradient = fixedRandom(3 * mesh_.free, 3);
  Vector z = gradient;
  binding.apply(inverse, gradient, z);
  EXPECT_EQ(z, gradient);
}

}  // namespace
}  // namespace haptic_cloth::layer_binding_test
