/// The private parameters of the node: a scene and how to run it. Each default stands here only.
#pragma once

#include <xmlrpcpp/XmlRpcValue.h>

#include <string>
#include <vector>

#include "haptic_cloth/haptics.h"
#include "haptic_cloth/scene.h"
#include "haptics/solver_probe.h"
#include "haptics/velocity_filter.h"
#include "ros/input/device_map.h"

namespace haptic_cloth {

/// How one probe is served.
struct ProbeSettings {
  DeviceOptions device;
  HapticOptions haptics;  ///< limits at the device; coupling as in the scene
};

/// What the lines of the mesh show by their colour.
enum class MeshColouring { Level, Tension, Bending };

/// "level" and so on, as parameters have them.
const char* toString(MeshColouring colouring);

/// @throws InputError for other words
MeshColouring toMeshColouring(const std::string& text, const std::string& origin, const std::string& key);

struct MarkerOptions {
  double rate = 30.0;         ///< [Hz]
  double force_scale = 0.05;  ///< length of the force arrow [m/N]
  MeshColouring colouring = MeshColouring::Level;
  double full_tension = 20.0;  ///< at which a line has its full colour [N/m]
  double full_bending = 0.05;  ///< the same [J/m²]
};

struct NodeOptions {
  std::string frame_id = "world";        ///< the cloth's frame, and that of all output
  std::string scene_file;                ///< read first; scene parameters then override single values
  std::string scene_directory;           ///< without scene_file: where paths of fabrics start
  double max_pose_age = 0.2;             ///< a pose with an older stamp is dropped [s]; 0: never
  double probe_timeout = kProbeTimeout;  ///< without poses this long the probe leaves the scene [s]
  double velocity_time_constant = kVelocityTimeConstant;  ///< low pass of the device's velocity [s]
  double step_budget = 0.025;  ///< wall clock of one step, or the scene's if that is less [s]; the
                               ///< force would time out while a hard step runs on; 0: none
  double gain_ramp =
      0.5;  ///< in which live changes of couplings and force scales are reached [s]; 0: at once
  MarkerOptions markers;
  double state_rate = 30.0;  ///< [Hz]
  DeviceOptions device;      ///< what holds for every probe's
  HapticOptions haptics;     ///< what holds for every probe
  double time_budget = 0.0;  ///< the scene's own; in `scene` stands the smaller of the two budgets [s]
  Scene scene;
  std::vector<ProbeSettings> probes;  ///< in the scene's order
};

/// Makes what follows from other options agree with them: the budget of a step, each probe's limits.
void settle(NodeOptions& options);

/// Checks everything that may change while the node runs, by the rules of files and parameters.
/// @throws InputError naming option, value and rule
void validateNodeOptions(const NodeOptions& options, const std::string& origin);

/// Reads the tree of private parameters: the keys of a scene file beside those of NodeOptions
/// (config/node.yaml shows them all).
/// @throws InputError for unknown keys, wrong types and impossible values
NodeOptions parseNodeOptions(const XmlRpc::XmlRpcValue& parameters, const std::string& origin);

}  // namespace haptic_cloth
