#include "tools/specimen.h"

#include <cmath>

#include "fabric/fabric_laws.h"

namespace haptic_cloth {
namespace {

constexpr int kAlong = 97, kAcross = 9, kLevels = 2;  ///< particles in the direction of the test, and across
constexpr double kLongestStrain = 4.0;                ///< at which a test of tension turns at the latest [-]
constexpr int kStepsPerSweep = 200;                   ///< of a sweep from zero to the largest deformation

Grid specimenGrid(KesTest test, Direction direction) {
  const double along = (test == KesTest::Bending ? 0.01 : 0.05) / (kAlong - 1), across = 0.20 / (kAcross - 1);
  return direction == kWarp ? Grid{kAlong, kAcross, kLevels, along, across}
                            : Grid{kAcross, kAlong, kLevels, across, along};
}

LeafMesh specimenLeaves(const Grid& grid, SpecimenMesh mesh) {
  LeafMesh leaves(grid, {}, mesh == SpecimenMesh::Finest ? 0 : kLevels);
  if (mesh != SpecimenMesh::Mixed) return leaves;
  std::vector<Cell> done;
  for (int level = kLevels; level > 0; --level) {  // finest in one corner, coarsest in the opposite one
    const double part = static_cast<double>(level) / (kLevels + 1);
    for (int j = 0; j < part * (grid.rows - 1); ++j) {
      for (int i = 0; i < part * (grid.columns - 1); ++i) {
        const Cell cell = leaves.leafAt(i, j);
        if (cell.level == level) leaves.split(cell, done);
      }
    }
  }
  return leaves;
}

/// The fabric with the law under test alone. On a coarse mesh a bent thread has chords for edges, which are
/// shorter than the thread: they must not add compression to bending.
Fabric testedFabric(const Fabric& fabric, KesTest test) {
  Fabric tested = fabric;
  if (test == KesTest::Bending) {
    tested.tensile = {};
    tested.shear = {};
  }
  return tested;
}

}  // namespace

Specimen::Specimen(const Fabric& fabric, KesTest test, Direction direction, SpecimenMesh mesh)
    : test_(test),
      direction_(direction),
      grid_(specimenGrid(test, direction)),
      leaves_(specimenLeaves(grid_, mesh)),
      mesh_(leaves_, fabric.areal_density),
      internal_(testedFabric(fabric, test), mesh_),
      area_(0.0) {
  if (test == KesTest::Bending) {
    for (const Triple& t : mesh_.triples) area_ += t.direction == direction ? t.area : 0.0;
  } else {
    for (const Patch& patch : mesh_.patches) area_ += patch.area;
  }
}

/// Tension: stretched along the thread. Shear: the crossing threads turn, none is stretched. Bending: threads
/// become polygons that turn by the same angle at each finest particle; finest edges are not stretched.
Vec3 Specimen::position(int i, int j, double deformation) const {
  const bool warp = direction_ == kWarp;
  const double u = warp ? i * grid_.dx : j * grid_.dy, v = warp ? j * grid_.dy : i * grid_.dx;
  const auto place = [warp](double along, double across, double up) {
    return warp ? Vec3(along, across, up) : Vec3(across, along, up);
  };
  switch (test_) {
    case KesTest::Tensile:
      return place((1.0 + deformation) * u, v, 0.0);
    case KesTest::Shear:
      return place(u + v * std::sin(deformation), v * std::cos(deformation), 0.0);
    case KesTest::Bending:
      break;
  }
  const double h = warp ? grid_.dx : grid_.dy, turn = deformation * h;
  const int middle = (kAlong - 1) / 2, steps = (warp ? i : j) - middle;
  if (std::abs(turn) < 1e-9) return place(u, v, 0.0);
  // Σ of unit chords with angles turn/2, 3 turn/2, ...: a polygon in a circle of radius h / (2 sin(turn/2)).
  const double radius = 0.5 * h / std::sin(0.5 * turn);
  return place(middle * h + radius * std::sin(steps * turn), v, radius * (1.0 - std::cos(steps * turn)));
}

void Specimen::place(double deformation, Field& x) const {
  x.resize(mesh_.nodes());
  for (int n = 0; n < mesh_.nodes(); ++n) {
    x.set(n, position(grid_.column(mesh_.particle[n]), grid_.row(mesh_.particle[n]), deformation));
  }
  mesh_.interpolateGhosts(x);
}

double Specimen::deform(double deformation) {
  const double step = test_ == KesTest::Bending ? 1e-3 : 1e-7;
  Field x, ahead, behind, gradient;
  gradient.clear(mesh_.nodes());
  place(deformation, x);
  place(deformation + step, ahead);
  place(deformation - step, behind);
  internal_.setNormals(x);
  internal_.evaluate(0, internal_.size(), x);
  internal_.addGradient(0, mesh_.nodes(), gradient);
  double work = 0.0;
  for (int n = 0; n < mesh_.nodes(); ++n) work += gradient[n].dot(ahead[n] - behind[n]);
  internal_.commit(0, internal_.size(), x);
  return work / (2.0 * step * area_);
}

const Loop& loopOf(const Fabric& fabric, KesTest test, Direction direction) {
  switch (test) {
    case KesTest::Tensile:
      return fabric.tensile[direction];
    case KesTest::Shear:
      return fabric.shear;
    case KesTest::Bending:
      break;
  }
  return fabric.bending[direction];
}

double largestDeformation(const Fabric& fabric, KesTest test, Direction direction) {
  if (test == KesTest::Bending) return 250.0;
  if (test == KesTest::Shear) return 8.0 / kes::kDegreesPerRadian;
  const Curve& tension = fabric.tensile[direction].upper();
  double low = 0.0, high = kLongestStrain;
  for (int k = 0; k < 60; ++k) {
    const double middle = 0.5 * (low + high);
    (tension(middle).force < kes::kLargestTension ? low : high) = middle;
  }
  return 0.5 * (low + high);
}

std::vector<KesRow> runKesTest(const Fabric& fabric, KesTest test, Direction direction, SpecimenMesh mesh) {
  Specimen specimen(fabric, test, direction, mesh);
  const Loop& loop = loopOf(fabric, test, direction);
  const double most = largestDeformation(fabric, test, direction);
  std::vector<KesRow> rows;
  const auto visit = [&](double s) {
    rows.push_back({s, specimen.deform(s), loop.upper()(s).force, loop.lower()(s).force});
  };
  double from = 0.0;
  visit(from);
  const std::vector<double> turns =
      test == KesTest::Tensile ? std::vector<double>{most, 0.0} : std::vector<double>{most, -most, most};
  for (const double to : turns) {
    const int steps = static_cast<int>(std::lround(kStepsPerSweep * std::abs(to - from) / most));
    for (int k = 1; k <= steps; ++k) visit(from + (to - from) * k / steps);
    from = to;
  }
  return rows;
}

LoopAreas loopAreas(const std::vector<KesRow>& rows, KesTest test) {
  LoopAreas areas{0.0, 0.0};
  const std::size_t first = test == KesTest::Tensile ? 0 : kStepsPerSweep;  // skip the virgin sweep
  for (std::size_t k = first + 1; k < rows.size(); ++k) {
    const KesRow &a = rows[k - 1], &b = rows[k];
    const double width = b.deformation - a.deformation;
    areas.measured += 0.5 * (a.force + b.force) * width;
    const bool rising = width > 0.0;
    areas.input += 0.5 * (rising ? a.upper + b.upper : a.lower + b.lower) * width;
  }
  return areas;
}

}  // namespace haptic_cloth
