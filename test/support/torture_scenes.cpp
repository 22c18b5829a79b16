// Parts of torture cases: sheets, fabrics, grips.
#include "support/torture.h"

namespace haptic_cloth {

std::string shippedFabric(const std::string& name) {
  return HAPTIC_CLOTH_SOURCE_DIR "/config/fabrics/" + name + ".yaml";
}

Torture tortureSheet(const std::string& name, const std::string& fabric_file, int warp, int weft,
                     double length, double width) {
  Torture wanted{name, fabric_file, sheetScene(loadFabric(fabric_file), warp, weft, length, width), {}};
  wanted.scene.air_damping = 0.5;
  wanted.scene.solver.minimizer.max_iterations = 200;  // some steps shall end short
  return wanted;
}

std::string lightFabric() {
  LinearFabric linear;
  linear.rigidity = 1e-5;
  linear.compression = 0.1;
  return writeFabric(linear);
}

ProbeOptions gripper(double length, double coupling_stiffness) {
  ProbeOptions probe;
  probe.radius = 0.004;
  probe.length = length;
  probe.orientation = lyingAlong(Vec3::UnitY());
  probe.coupling_stiffness = coupling_stiffness;
  return probe;
}

}  // namespace haptic_cloth
