/// Elements that survive a change of the mesh.
/// Criteria: the definition, by comparing each element with each; memory bit for bit; the energy
/// made by a change is that stored after minus that before (an identity; sums of some hundred terms
/// round at 1e-12).
#include <gtest/gtest.h>

#include <optional>
#include <tuple>

#include "energy/internal_energy.h"
#include "support/derivatives.h"
#include "support/scenes.h"
#include "support/tolerance.h"

namespace haptic_cloth::mesh_change_elements_test {
namespace {

const Grid kGrid{17, 9, 2, 0.01, 0.01};

/// Flat cloth with cells of three sizes; one cell splits and four others merge.
class MeshChangeTest : public testing::Test {
 protected:
  MeshChangeTest() : leaves_(kGrid, {}, 2), mesh_(refined(leaves_), 0.15) {
    x_ = flat();
    change_.emplace(mesh_);
  }

  static const LeafMesh& refined(LeafMesh& leaves) {
    std::vector<Cell> done;
    for (const auto& [i, j] : {std::pair(0, 0), {2, 2}, {8, 4}}) leaves.split(leaves.leafAt(i, j), done);
    return leaves;
  }
  void change() {
    std::vector<Cell> done;
    leaves_.split(leaves_.leafAt(12, 0), done);
    ASSERT_TRUE(leaves_.canMerge({8, 4, 2}));
    leaves_.merge({8, 4, 2});
    mesh_.rebuild(leaves_);
  }
  Field flat() const {
    std::vector<Vec3> positions;
    for (const int p : mesh_.particle) {
      positions.emplace_back(0.0103 * kGrid.column(p), 0.0101 * kGrid.row(p), 0.0);  // stretched
    }
    return Field(positions);
  }

  LeafMesh leaves_;
  ActiveMesh mesh_;
  Field x_;
  std::optional<MeshChange> change_;
};

TEST_F(MeshChangeTest, WithoutAChangeAllStays) {
  change_->begin(mesh_, x_);
  change_->end(mesh_, x_);
  for (int e = 0; e < static_cast<int>(mesh_.edges.size()); ++e) EXPECT_EQ(change_->edges().was[e], e);
  for (int t = 0; t < static_cast<int>(mesh_.triples.size()); ++t) EXPECT_EQ(change_->triples().was[t], t);
  for (int k = 0; k < static_cast<int>(mesh_.patches.size()); ++k) EXPECT_EQ(change_->patches().was[k], k);
}

TEST_F(MeshChangeTest, WhatHasTheSameParticlesStays) {
  const std::vector<int> then = mesh_.particle;
  change_->begin(mesh_, x_);
  change();
  change_->end(mesh_, flat());
  const auto edge_of = [](const Edge& e, const std::vector<int>& particle) {
    return std::tuple(e.direction, particle[e.a], particle[e.b], e.width);
  };
  const auto triple_of = [](const Triple& t, const std::vector<int>& particle) {
    return std::tuple(t.direction, particle[t.l], particle[t.c], particle[t.r], particle[t.a], particle[t.b],
                      t.sagitta, t.area);
  };
  const auto patch_of = [](const Patch& p, const std::vector<int>&) {
    return std::tuple(p.cell.i, p.cell.j, p.cell.level);
  };
  const auto compare = [&](const auto& followed, const auto& now, const auto& identity) {
    int found = 0;
    std::vector<char> stays(followed.before.size(), 0);
    for (int k = 0; k < static_cast<int>(now.size()); ++k) {
      int was = -1;
      for (int b = 0; b < static_cast<int>(followed.before.size()); ++b) {
        if (identity(followed.before[b], then) == identity(now[k], mesh_.particle)) was = b;
      }
      EXPECT_EQ(followed.was[k], was) << k;
      EXPECT_EQ(followed.isNew(k), was < 0);
      if (was >= 0) stays[was] = 1;
      found += was >= 0 ? 1 : 0;
    }
    EXPECT_EQ(followed.stays, stays);
    EXPECT_GT(found, 0);
    EXPECT_LT(found, static_cast<int>(now.size()));
  };
  compare(change_->edges(), mesh_.edges, edge_of);
  compare(change_->triples(), mesh_.triples, triple_of);
  compare(change_->patches(), mesh_.patches, patch_of);
}

TEST_F(MeshChangeTest, WhatMovedIsNew) {
  change_->begin(mesh_, x_);
  const int moved = mesh_.patches[0].nodes[3];
  x_.add(moved, Vec3(0.0, 0.0, 1e-9));
  change_->end(mesh_, x_);
  for (int e = 0; e < static_cast<int>(mesh_.edges.size()); ++e) {
    EXPECT_EQ(change_->edges().isNew(e), mesh_.edges[e].a == moved || mesh_.edges[e].b == moved);
  }
  EXPECT_TRUE(change_->patches().isNew(0));
}

enum class Kind { Elastic, Hysteretic, Twisting };

Fabric fabricOf(Kind kind) {
  LinearFabric linear;
  linear.rigidity = 1e-5;
  Fabric fabric = makeFabric(linear);
  if (kind == Kind::Twisting) fabric.twist_rigidity = 2e-5;
  if (kind != Kind::Hysteretic) return fabric;
  fabric.tensile[kWarp] = Loop(-0.05, 0.05, {-50.0, 0.0, 60.0}, {-50.0, 0.0, 40.0}, 3.0);
  fabric.bending = {Loop(-256.0, 256.0, {-2e-3, 5e-4, 3e-3}, {-3e-3, -5e-4, 2e-3}, 30.0),
                    Loop(Curve::linear(1e-5))};
  fabric.shear = Loop(-0.1, 0.1, {-2.0, 1.0, 4.0}, {-4.0, -1.0, 2.0}, 30.0);
  return fabric;
}

/// Fabrics with and without memory; a cell splits or four merge.
class FabricChange : public MeshChangeTest, public testing::WithParamInterface<std::tuple<Kind, bool>> {};

TEST_P(FabricChange, KeepsWhatStaysAndCountsWhatItMade) {
  const auto [kind, splits] = GetParam();
  const Fabric fabric = fabricOf(kind);
  InternalEnergy internal(fabric, mesh_);
  ForceHistory history(kGrid);
  internal.setNormals(x_);
  Field shaken = x_;
  const Eigen::VectorXd noise = 3e-4 * fixedRandom(3 * mesh_.nodes(), 7);
  for (int n = 0; n < mesh_.nodes(); ++n) shaken.add(n, noise.segment<3>(3 * n));
  internal.commit(0, internal.size(), shaken);

  const auto total = [](const InternalEnergy::Energy& e) { return e.stretch + e.bend + e.shear; };
  const auto memory = [&internal](int element) { return internal.law(element, 0.0).force; };
  const double before = total(internal.stored(x_));
  std::vector<double> then;
  for (int k = 0; k < internal.elements(); ++k) then.push_back(memory(k));
  const int edges_then = static_cast<int>(mesh_.edges.size()),
            triples_then = static_cast<int>(mesh_.triples.size());
  change_->begin(mesh_, x_);
  internal.beginChange(x_);
  internal.remember(x_, history);
  std::vector<Cell> done;
  const Cell parent = splits ? leaves_.leafAt(12, 0) : Cell{8, 4, 2};
  if (splits) {
    leaves_.split(parent, done);
    ASSERT_EQ(done.size(), 1u);
  } else {
    leaves_.merge(parent);
  }
  mesh_.rebuild(leaves_);
  x_ = flat();
  internal.resize();
  internal.setNormals(x_);
  internal.endChange(x_);
  splits ? history.split(parent) : history.merge(parent);
  internal.recall(x_, history);
  change_->end(mesh_, x_);
  EXPECT_NEAR(internal.madeByChange(x_), total(internal.stored(x_)) - before, tolerance(1e-12) * before);

  const int edges = static_cast<int>(mesh_.edges.size()), triples = static_cast<int>(mesh_.triples.size());
  int kept = 0;
  for (int k = 0; k < internal.elements(); ++k) {
    const bool edge = k < edges, triple = !edge && k < edges + triples;
    const int was = edge     ? change_->edges().was[k]
                    : triple ? change_->triples().was[k - edges]
                             : change_->patches().was[k - edges - triples];
    if (was < 0) continue;
    ++kept;
    EXPECT_EQ(memory(k), then[was + (edge ? 0 : triple ? edges_then : edges_then + triples_then)]) << k;
  }
  EXPECT_GT(kept, internal.elements() / 2);
}

INSTANTIATE_TEST_SUITE_P(Kinds, FabricChange,
                         testing::Combine(testing::Values(Kind::Elastic, Kind::Hysteretic, Kind::Twisting),
                                          testing::Bool()));

}  // namespace
}  // namespace haptic_cloth::mesh_change_elements_test
