/// The virtual Kawabata tests: a specimen meshed like the cloth, deformed as the KES-F instruments do.
#pragma once

#include <vector>

#include "energy/internal_energy.h"
#include "haptic_cloth/fabric.h"

namespace haptic_cloth {

enum class KesTest { Tensile, Shear, Bending };
enum class SpecimenMesh { Finest, Coarsest, Mixed };

/// A specimen of 97 x 9 particles in three levels: 5 x 20 cm for tension and shear [KES-FB1], 1 x 20 cm for
/// bending [KES-FB2].
class Specimen {
 public:
  Specimen(const Fabric& fabric, KesTest test, Direction direction, SpecimenMesh mesh);

  /// Moves every particle to the deformation (strain [-], angle [rad] or curvature [1/m]) and makes it
  /// history.
  /// @return force per width ([N/m] or [N·m/m]): virtual work of the particles' forces per area deformed
  double deform(double deformation);

 private:
  void place(double deformation, Field& x) const;
  Vec3 position(int i, int j, double deformation) const;

  KesTest test_;
  Direction direction_;
  Grid grid_;
  LeafMesh leaves_;
  ActiveMesh mesh_;
  InternalEnergy internal_;
  double area_;  ///< that the deformation acts on [m²]
};

/// One row of a test's curve, with the branches of the fabric's loop beside it.
struct KesRow {
  double deformation, force, upper, lower;
};

/// The loop a test is compared with.
const Loop& loopOf(const Fabric& fabric, KesTest test, Direction direction);

/// Largest deformation of a test: where tension reaches 500 gf/cm, at most 400 %; 8° or 2.5/cm.
double largestDeformation(const Fabric& fabric, KesTest test, Direction direction);

/// Runs a test. Tension: up and down once. Shear and bending: up, down to the negative end and up again.
std::vector<KesRow> runKesTest(const Fabric& fabric, KesTest test, Direction direction, SpecimenMesh mesh);

/// Area of the loop that the last full cycle of a curve went round, and that between the branches over the
/// same range: energy lost per area [J/m²].
struct LoopAreas {
  double measured, input;
};
LoopAreas loopAreas(const std::vector<KesRow>& rows, KesTest test);

}  // namespace haptic_cloth
