/// One probe in the solver's thread, and what it shares with the thread of its device.
#pragma once

#include <atomic>

#include "haptic_cloth/haptics.h"
#include "haptic_cloth/simulation.h"
#include "haptics/probe_tracker.h"

namespace haptic_cloth {

/// Without poses this long a probe leaves the scene, unless its user asks for another time [s].
constexpr double kProbeTimeout = 1.0;

/// Grasp of a probe on the cloth that it touches.
enum class GraspState { Open, Closed, Holding };

/// Values that the threads of one probe share. Each mailbox has one writer and one reader.
struct ProbeExchange {
  Mailbox<DeviceSample> device_for_solver;  ///< device's thread → solver's thread
  Mailbox<ProbeSnapshot> snapshot;          ///< solver's thread → device's thread

  std::atomic<bool> present{false};       ///< the solver has a pose of it
  std::atomic<bool> grasp_wanted{false};  ///< set from any thread; the solver opens it
  std::atomic<GraspState> grasp{GraspState::Open};
};

/// Values of a probe for display.
struct ProbeView {
  ProbeReport report;
  Quat orientation = Quat::Identity();
  GraspState grasp = GraspState::Open;
};

/// Carries poses from the exchange to the simulation, and snapshots back. It belongs to the solver's
/// thread.
class SolverProbe {
 public:
  /// @param number of the probe in the scene
  /// @param timeout without poses this long the probe leaves the scene [s]
  /// @param exchange must outlive this object
  SolverProbe(int number, double timeout, ProbeExchange& exchange)
      : number_(number), timeout_(timeout), exchange_(exchange) {}

  /// Changes the constructor's timeout [s].
  void setTimeout(double timeout) { timeout_ = timeout; }

  /// Hands the newest pose and the grasp to the simulation, or takes the probe out of it if its
  /// device is silent. If the device has jumped, the probe enters the scene again.
  /// @param now steady clock [s]
  void takeDevice(Simulation& simulation, double now);

  /// Publishes the result of the last step for the probe.
  /// @param pace wall-clock time of a step [s]  @param now steady clock [s]
  void publishSnapshot(const Simulation& simulation, double pace, double now);

  /// Lets go of the cloth, as in a pause.
  void open(Simulation& simulation);

  /// Forgets the cloth: the simulation was reset, or continues from another state.
  void forget();

  ProbeView view(const Simulation& simulation) const;

 private:
  void leave(Simulation& simulation);
  void showGrasp(const Simulation& simulation);

  int number_;
  double timeout_;  ///< [s]
  ProbeExchange& exchange_;
  bool present_ = false;
  bool closed_ = false;
  int cloth_ = 0;  ///< see ProbeSnapshot
  ProbeTracker tracker_;
  DeviceSample device_;  ///< of the current step
};

}  // namespace haptic_cloth
