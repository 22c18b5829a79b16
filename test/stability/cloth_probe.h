/// World of the closed loops with the real solver.
#pragma once

#include "haptic_cloth/simulation.h"
#include "stability/closed_loop.h"
#include "support/scenes.h"

namespace haptic_cloth {

constexpr double kTop = 0.05;  ///< height of the top of the box [m]

inline Scene smallDrape(double coupling, double damping) {
  Scene scene = boxDrape(13);
  scene.cloth.size = {0.12, 0.12};
  scene.cloth.pose.position.z() = kTop + 0.002;
  scene.obstacles[0].size = Vec3(0.08, 0.08, 0.05);
  scene.obstacles[0].pose.position.z() = kTop - 0.025;
  scene.probes[0].coupling_stiffness = coupling;
  scene.probes[0].coupling_damping = damping;
  return scene;
}

/// Small cloth over a box, and the device of the probe. z = 0 is where the probe rests on the
/// cloth.
class ClothWorldProbe : public ProbeWorld {
 public:
  explicit ClothWorldProbe(const Scene& scene)
      : simulation_(scene), origin_(0.0, 0.0, kTop + scene.cloth.fabric.thickness + scene.probes[0].radius) {}
  ProbeReport solve(const Vec3& device, const Vec3& device_velocity) override {
    simulation_.setDevice(device + origin_, device_velocity);
    failed_ += simulation_.step().failed;
    ProbeReport report = simulation_.probe();
    report.device -= origin_;
    report.proxy -= origin_;
    return report;
  }
  int failed() const { return failed_; }

 private:
  Simulation simulation_;
  Vec3 origin_;
  int failed_ = 0;
};

}  // namespace haptic_cloth
