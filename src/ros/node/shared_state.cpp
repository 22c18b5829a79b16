#include "ros/node/shared_state.h"

#include "ros/input/device_map.h"

namespace haptic_cloth {

SharedProbe::SharedProbe(const NodeOptions& options, std::size_t number) {
  const ProbeSettings& settings = options.probes[number];
  const HapticOptions haptics = limitsAtProbe(settings.haptics, settings.device);
  const int probe = static_cast<int>(number);
  if (settings.device.kind == DeviceKind::Admittance) {
    admittance.emplace(options.scene, probe, haptics);
  } else {
    impedance.emplace(options.scene, probe, haptics);
  }
}

SharedState::SharedState(const NodeOptions& options)
    : obstacles(options.scene.obstacles.size()), recording(!options.record.empty()) {
  for (std::size_t k = 0; k < options.probes.size(); ++k) probes.emplace_back(options, k);
}

}  // namespace haptic_cloth
