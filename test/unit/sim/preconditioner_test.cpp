// Multilevel preconditioner and its hat functions.
// Criteria:
// - Children lie at the mean of their parents and give all of their entries to them, by definition.
// - Symmetry holds to the rounding of the hats' part, which passes the levels up and down in single
//   precision. Each of the four passes of a level rounds by at most 2^-24, and a part is not larger
//   than the sum.
// - The block of a single free node is inverted exactly, to round-off.
// - The condition number grows at most as the square of the number of levels, so the iterations as
//   that number [Bramble, Pasciak & Xu, Parallel multilevel preconditioners, Math. Comp. 55, 1990].
// - The iterations of Jacobi grow as the number of particles along a side [Saad, Iterative Methods
//   for Sparse Linear Systems, 2003].
#include <gtest/gtest.h>

#include <vector>

#include "haptic_cloth/simulation.h"
#include "mesh/hat_levels.h"
#include "support/pressed_sheet.h"
#include "support/tolerance.h"

namespace haptic_cloth::preconditioner_test {
namespace {

constexpr double kLevels = 4.0, kRounding = 4.0 * kLevels * 0x1p-24;  // 17 × 17: spans 2, 4, 8, 16

class Hats : public ObjectiveTest {};
class MultilevelTest : public ObjectiveTest {
 protected:
  explicit MultilevelTest(double length = 0.0) : ObjectiveTest(length) {}

  void expectSymmetricAndPositive() {
    const int n = objective_.size();
    Vector gradient = Vector::Zero(objective_.capacity()), a = gradient, b = gradient, pa = gradient,
           pb = gradient;
    objective_.evaluate(start_, gradient);
    ASSERT_TRUE(contacts_.probeTouched(0));
    objective_.fitPreconditioner(false);
    for (unsigned seed = 1; seed <= 10; ++seed) {
      a.head(n) = fixedRandom(n, seed);
      b.head(n) = fixedRandom(n, 100 + seed);
      for (const HeldNode& held : objective_.held()) {  // no unknowns
        for (int c = 0; c < 3; ++c) a[c * mesh_.free + held.node] = b[c * mesh_.free + held.node] = 0.0;
      }
      objective_.precondition(a, pa);
      objective_.precondition(b, pb);
      const double scale = std::sqrt(a.head(n).dot(pa.head(n)) * b.head(n).dot(pb.head(n)));
      EXPECT_GT(a.head(n).dot(pa.head(n)), 0.0);
      EXPECT_NEAR(a.head(n).dot(pb.head(n)), b.head(n).dot(pa.head(n)), tolerance(kRounding) * scale);
    }
  }
};

/// The same with a capsule whose turn is solved for.
class TurningMultilevelTest : public MultilevelTest {
 protected:
  TurningMultilevelTest() : MultilevelTest(0.02) {}
};

TEST_F(Hats, ChildrenLieBetweenTheirParents) {
  const HatLevels hats(mesh_);
  const auto place = [&](int node) {
    return Vec3(grid_.column(mesh_.particle[node]), grid_.row(mesh_.particle[node]), 0.0);
  };
  std::vector<int> times(hats.points(), 0);
  for (const HatLevels::Level& level : hats.levels()) {
    for (int k = level.children; k < level.children_end; ++k) {
      const HatLevels::Child& child = hats.children()[k];
      ++times[child.point];
      Vec3 mean = Vec3::Zero();
      for (const int parent : child.parents) {
        ASSERT_LT(parent, mesh_.nodes()) << "16 cells have no points past their end";
        mean += 0.25 * place(parent);
      }
      EXPECT_EQ(mean, place(child.point));
    }
  }
  const int span = 1 << hats.levels().size();
  for (int n = 0; n < mesh_.nodes(); ++n) {
    const bool on_last =
        grid_.column(mesh_.particle[n]) % span == 0 && grid_.row(mesh_.particle[n]) % span == 0;
    EXPECT_EQ(times[n], on_last ? 0 : 1) << n;
  }
}

void expectChildrenGiveAll(const Grid& grid) {
  const LeafMesh leaves(grid, {}, 0);
  const ActiveMesh mesh(leaves, 0.1);
  const HatLevels hats(mesh);
  EXPECT_GT(hats.points(), mesh.nodes());
  std::vector<double> values(hats.points(), 0.0);
  for (int n = 0; n < mesh.nodes(); ++n) values[n] = 1.0 + n;
  const double total = 0.5 * mesh.nodes() * (mesh.nodes() + 1);
  for (const HatLevels::Level& level : hats.levels()) {
    double children = 0.0, given = 0.0, shares = 0.0;
    for (int k = level.children; k < level.children_end; ++k) children += values[hats.children()[k].point];
    for (int k = level.hats; k < level.hats_end; ++k) {
      const HatLevels::Hat& hat = hats.hats()[k];
      const double before = values[hat.point];
      hats.gatherChildren(hat, values.data());
      given += values[hat.point] - before;
      shares += hat.shares;
    }
    for (int k = level.children; k < level.children_end; ++k) values[hats.children()[k].point] = 0.0;
    EXPECT_NEAR(given, children, tolerance(1e-12) * total);
    EXPECT_EQ(shares, level.children_end - level.children);
  }
  EXPECT_EQ(values[hats.nowhere()], 0.0);
  double left = 0.0;
  for (const double value : values) left += value;
  EXPECT_NEAR(left, total, tolerance(1e-12) * total);
}

TEST(HatLevelsTest, ChildrenGiveAllToTheirParents) {
  expectChildrenGiveAll({20, 6, 0, 0.01, 0.01});  // with 19 and 5 cells, lattices end beyond the cloth
}

TEST(HatLevelsTest, AStripNeedsNoMoreThanItsParticles) {
  // Its coarsest spacing is 32768; a lattice of whole spacings would have 65537 × 32769 points.
  expectChildrenGiveAll({65537, 5, 0, 0.01, 0.01});
  expectChildrenGiveAll({5, 65537, 0, 0.01, 0.01});
}

TEST(HatLevelsTest, NarrowCellsGrowSquareFirst) {
  // Cells 5 times as long as wide. Criterion: no direction doubles while it is longer by more than the root
  // of two, where doubling the other alone makes cells squarer; so at the end they differ by at most that
  // factor.
  const Grid grid{33, 129, 0, 0.05, 0.01};
  expectChildrenGiveAll(grid);
  const HatLevels hats(ActiveMesh(LeafMesh(grid, {}, 0), 0.1));
  std::array<double, 2> spacing{grid.dx, grid.dy};
  const double most = std::sqrt(2.0);
  ASSERT_GT(hats.levels().size(), 3u);
  for (const HatLevels::Level& level : hats.levels()) {
    for (const int d : {0, 1}) {
      EXPECT_TRUE(level.spans[d] == 0 || spacing[d] <= most * spacing[1 - d]);
    }
    for (const std::size_t d : {0u, 1u}) spacing[d] *= level.spans[d] > 0 ? 2.0 : 1.0;
  }
  EXPECT_LT(std::max(spacing[0], spacing[1]), most * std::min(spacing[0], spacing[1]));
}

TEST_F(MultilevelTest, IsSymmetricAndPositive) { expectSymmetricAndPositive(); }

TEST_F(TurningMultilevelTest, IsSymmetricAndPositive) { expectSymmetricAndPositive(); }

TEST_F(TurningMultilevelTest, IsSymmetricAndPositiveWithWhatItHolds) {
  ASSERT_NO_FATAL_FAILURE(grasp());
  expectSymmetricAndPositive();
}

TEST(Multilevel, InvertsTheBlockOfASingleFreeNode) {
  // With H P g = g, P g · H P g = P g · g. All other nodes are pinned.
  LinearFabric linear;
  linear.rigidity = 1e-5;
  Scene scene = sheetScene(makeFabric(linear), 3, 3, 0.02, 0.03);
  pinAllSides(scene);
  const Grid grid{3, 3, 0, 0.01, 0.015};
  const LeafMesh leaves(grid, scene.cloth.pins, 0);
  const ActiveMesh mesh(leaves, scene.cloth.fabric.areal_density);
  ASSERT_EQ(mesh.free, 1);
  InternalEnergy internal(scene.cloth.fabric, mesh);
  Team team(1);
  ContactSet contacts(grid, {}, {}, {5e-4, 1e-3, 1e-3}, team);
  scene.probes.clear();
  TimeIntegrator integrator(Integrator::Euler, scene.solver.time_step, scene.air_damping, grid);
  ClothObjective objective(scene, mesh, integrator, internal, contacts, team);
  Field nodes, velocities;  // at rest
  for (Field* field : {&nodes, &velocities}) field->clear(mesh.nodes());
  for (int n = 0; n < mesh.nodes(); ++n) {
    nodes.set(n, Vec3(0.01 * grid.column(mesh.particle[n]), 0.015 * grid.row(mesh.particle[n]), 0.0));
  }
  nodes.add(0, Vec3(1e-3, 5e-4, 2e-3));  // stretched, sheared and bent
  internal.setNormals(nodes);
  contacts.collectProbes(mesh, nodes, std::vector<double>(mesh.nodes(), 1e-3), velocities, {});
  contacts.collectObstacles(mesh, nodes, std::vector<double>(mesh.nodes(), 1e-3), velocities);
  objective.begin(nodes, velocities, {});
  Vector x = Vector::Zero(objective.capacity()), gradient = x, z = x;
  objective.pack(nodes, x);
  objective.evaluate(x, gradient);
  objective.fitPreconditioner(false);
  for (unsigned seed = 1; seed <= 5; ++seed) {
    gradient.head(3) = fixedRandom(3, seed);
    objective.precondition(gradient, z);
    const double work = z.head(3).dot(gradient.head(3));
    EXPECT_NEAR(objective.along(z, -1.0).quadratic_form, work, tolerance(1e-12) * work);
  }
}

/// Iterations of one long step of a cloth that hangs from its upper edge. It has almost no inertia,
/// so all of it must find its position at once.
int iterations(Preconditioner preconditioner, int particles) {
  // Coarsening in both directions suits a fabric that is as stiff in shear as in tension.
  LinearFabric isotropic;
  isotropic.shear_modulus = 0.5 * isotropic.stiffness;
  Scene scene = sheetScene(makeFabric(isotropic), particles, particles, 0.2, 0.2);
  hangDown(scene);
  pin(scene, 0, 0, 0, particles - 1);
  scene.gravity *= 1e-3;  // almost linear
  scene.solver.time_step = 0.05;
  scene.solver.minimizer.preconditioner = preconditioner;
  scene.solver.minimizer.tolerance = 1e-4;
  scene.solver.minimizer.max_iterations = 5000;
  Simulation simulation(scene);
  const StepReport report = simulation.step();
  EXPECT_EQ(report.minimizer.why, Termination::Converged);
  return report.minimizer.iterations;
}

TEST(Multilevel, IterationsDoNotGrowWithTheParticles) {
  const int coarse = iterations(Preconditioner::Multilevel, 17),
            fine = iterations(Preconditioner::Multilevel, 65);
  const int jacobi_coarse = iterations(Preconditioner::Jacobi, 17),
            jacobi_fine = iterations(Preconditioner::Jacobi, 65);
  RecordProperty("iterations", std::to_string(coarse) + " " + std::to_string(fine) + " " +
                                   std::to_string(jacobi_coarse) + " " + std::to_string(jacobi_fine));
  std::printf("  iterations at 17 and 65 particles a side: multilevel %d, %d; Jacobi %d, %d\n", coarse, fine,
              jacobi_coarse, jacobi_fine);
  // Three and five levels; four times as many particles along a side.
  EXPECT_LT(fine, tolerance(5.0 / 3.0) * coarse);
  EXPECT_GT(jacobi_fine, 3.0 * jacobi_coarse);
}

}  // namespace
}  // namespace haptic_cloth::preconditioner_test
