/// Private parameters of the node: a scene and how to run it. Their rows are in node_table.h.
#pragma once

#include <xmlrpcpp/XmlRpcValue.h>

#include <string>
#include <vector>

#include "haptic_cloth/haptics.h"
#include "haptic_cloth/scene.h"
#include "haptic_cloth/step_pacer.h"
#include "ros/input/device_map.h"

namespace haptic_cloth {

/// Settings of one probe.
struct ProbeSettings {
  DeviceOptions device;
  HapticOptions haptics;  ///< limits at the device; coupling from the scene
};

/// Quantity that the colour of the mesh lines shows.
enum class MeshColouring { Level, Tension, Bending };

struct MarkerOptions {
  double rate = 30.0;         ///< [Hz]
  double force_scale = 0.05;  ///< length of the force arrow [m/N]
  MeshColouring colouring = MeshColouring::Level;
  double full_tension = 20.0;  ///< tension at which a line has its full colour [N/m]
  double full_bending = 0.05;  ///< bending energy at which a line has its full colour [J/m²]
};

struct NodeOptions {
  std::string frame_id = "world";  ///< frame of the cloth and of all output
  std::string scene_file;          ///< read first; scene parameters override its values
  /// Scene parameters that override a scene file, as KEY=VALUE; empty without a file.
  std::vector<std::string> overrides;
  std::string scene_directory;  ///< without scene_file: folder of relative fabric paths
  double max_pose_age = 0.2;    ///< a pose with an older stamp is dropped [s]; 0: never
  /// Limit of wall time per step [s]; 0: none. The smaller of this and the scene's budget counts.
  /// Without it the force would time out during a hard step.
  double step_budget = 0.025;
  PaceOptions pace;
  std::string record;      ///< file for a recording; empty: none
  double gain_ramp = 0.5;  ///< duration of gain ramps after a live change [s]; 0: at once
  MarkerOptions markers;
  double state_rate = 30.0;  ///< [Hz]
  DeviceOptions device;      ///< default of all probes
  HapticOptions haptics;     ///< same for all probes
  double time_budget = 0.0;  ///< budget of the scene itself; `scene` holds the smaller one [s]
  Scene scene;
  std::vector<ProbeSettings> probes;  ///< in the order of the scene
};

/// Updates what depends on other options: the time budget of a step and the limits of each probe.
void settle(NodeOptions& options);

/// Checks everything that may change while the node runs, by the rules of files and parameters.
/// @throws InputError with option, value and rule
void validateNodeOptions(const NodeOptions& options, const std::string& origin);

/// deviceWarnings() of all probes, each with the name of its probe in front.
std::vector<std::string> deviceWarnings(const NodeOptions& options);

/// deviceWarnings(), and one that names the scene parameters that override the scene file: they may be those
/// of an earlier launch.
std::vector<std::string> startWarnings(const NodeOptions& options);

/// Reads the tree of private parameters: the keys of a scene file and those of NodeOptions (all are
/// in config/node.yaml).
/// @throws InputError for an unknown key, a wrong type or an invalid value
NodeOptions parseNodeOptions(const XmlRpc::XmlRpcValue& parameters, const std::string& origin);

}  // namespace haptic_cloth
