/// One probe in the solver thread.
#pragma once

#include "haptic_cloth/simulation.h"
#include "haptics/probe_tracker.h"
#include "ros/node/shared_state.h"
#include "ros/options/node_options.h"

namespace haptic_cloth {

/// Between the mailboxes of a probe and the simulation. One thread calls it.
class SolverProbe {
 public:
  /// @param number of the probe in the scene
  SolverProbe(const NodeOptions& options, int number, Simulation& simulation, SharedProbe& shared);

  /// @param timeout without poses this long the probe leaves the scene [s]
  void setTimeout(double timeout) { timeout_ = timeout; }

  /// Hands the newest pose and the grasp to the simulation, or takes the probe out of it when its device is
  /// silent. Where the device has jumped the probe begins anew.
  void takeDevice();

  /// Tells the haptic thread what the last step made of the probe. @param pace wall-clock time of a step [s]
  void publishSnapshot(double pace);

  /// Lets go of the cloth, as in a pause.
  void open();

  /// The simulation has been reset, or goes on from another state.
  void forget();

  /// What is shown of it.
  ProbeView view() const;

 private:
  void leave();
  void showGrasp();

  int number_;
  double timeout_;  ///< [s]
  Simulation& simulation_;
  SharedProbe& shared_;
  bool present_ = false;
  bool closed_ = false;
  int cloth_ = 0;  ///< see ProbeSnapshot
  ProbeTracker tracker_;
  DeviceSample device_;  ///< of the step in hand
  Quat orientation_ = Quat::Identity();
};

}  // namespace haptic_cloth
