/// Values that the threads of the node share. Mailboxes have one writer and one reader each, named here.
#pragma once

#include <ros/time.h>

#include <atomic>
#include <cstdint>
#include <deque>
#include <limits>
#include <optional>
#include <string>
#include <vector>

#include "haptic_cloth/haptic_session.h"
#include "haptic_cloth/report.h"
#include "haptic_cloth/simulation.h"
#include "haptic_cloth/step_pacer.h"
#include "haptics/lateness.h"
#include "ros/node/solver_tasks.h"
#include "ros/node/steady_clock.h"
#include "ros/options/live_options.h"

namespace haptic_cloth {

/// A device pose with what the wrench that answers it needs: exact stamp and frame of its message.
struct StampedPose {
  double received = -1.0;  ///< steady clock [s]; < 0: none yet
  Pose pose;               ///< in the cloth's frame
  ros::Time stamp;
  std::string frame_id;                    ///< of the message
  Vec3 frame_position = Vec3::Zero();      ///< of that frame in the cloth's [m]
  Quat frame_rotation = Quat::Identity();  ///< of that frame in the cloth's
};

/// A measured force with what its answer needs.
struct StampedForce {
  double received = -1.0;     ///< steady clock [s]; < 0: none yet
  Vec3 force = Vec3::Zero();  ///< of the hand on the device, in the driver's axes [N]
  ros::Time stamp;
  std::string frame_id;                    ///< of the message
  Quat frame_rotation = Quat::Identity();  ///< of that frame in the cloth's
};

/// Values of a probe for display.
struct ProbeView {
  ProbeReport report;
  Quat orientation = Quat::Identity();
  GraspState grasp = GraspState::Open;
  double force_error = 0.0;  ///< estimated error of the force on the hand [N]
};

/// Steps since the start of the node that failed, each of which restored the last good state, or were made
/// in part.
struct FailedSteps {
  std::uint64_t count = 0;
  std::uint64_t out_of_reach = 0;            ///< of these: parts of the cloth may have met unseen
  std::uint64_t made_in_part = 0;            ///< not failed: only a part of their motion was safe
  Termination why = Termination::Converged;  ///< of the newest
  double when = -std::numeric_limits<double>::infinity();  ///< of the newest, steady clock [s]

  void note(Termination reason, double now) {
    ++count;
    out_of_reach += reason == Termination::OutOfReach;
    why = reason;
    when = now;
  }
};

/// A copy of what is shown.
struct DisplayFrame {
  double taken = -1.0;  ///< steady clock at the copy [s]; < 0: none yet
  ros::Time stamp;      ///< of the copy
  double time = 0.0;    ///< simulated [s]
  std::vector<Vec3> positions;
  std::vector<CellView> cells;
  std::vector<float> tension, bending;
  std::vector<ProbeView> probes;  ///< in the scene's order, as the obstacles
  std::vector<Pose> obstacles;
  QualityReport quality;
  FailedSteps failed;
  StepReport last;
};

/// The solver over one window of about a second, and the cloth at its end. A pause, a reset and a
/// loaded state end a window early.
struct SolverStats {
  double taken = -1.0;          ///< steady clock at the start or end of the last window [s]; < 0: none yet
  double wall = 0.0;            ///< length of the window [s]; 0: it ended early, or has just begun
  double time = 0.0;            ///< simulated since reset [s]
  int steps = 0;                ///< in the window
  double real_time_factor = 0;  ///< simulated over wall time [-]
  double slipped_share = 0.0;   ///< share of the wall time that slipped [-]
  double iterations = 0.0;      ///< mean a step [-]
  double kinetic = 0.0;         ///< [J]
  bool meets_itself = true;     ///< see Simulation::meetsItself()
  QualityReport quality;
  FailedSteps failed;
  std::vector<double> force_errors;  ///< of the forces on the hands, estimated [N]
  StepReport last;
};

/// The haptic thread over one window of about a second.
struct HapticStats {
  double taken = -1.0;  ///< steady clock at the end of the window [s]; < 0: none yet
  double wall = 0.0;    ///< [s]
  double rate = 0.0;    ///< that was wanted [Hz]
  int ticks = 0;
  std::uint64_t given_up = 0;  ///< ticks since start that were too late to be made up for
  LatenessHistogram lateness;  ///< of what ticks send: from when they are due until it is published
};

/// Force and torque that a hand feels.
struct FeltForce {
  HapticStatus status = HapticStatus::NoPose;
  Vec3 force = Vec3::Zero();   ///< on the hand, in the cloth's axes [N]
  Vec3 torque = Vec3::Zero();  ///< on the hand, in the cloth's axes [N·m]
  double share = 1.0;          ///< of the coupling's force, see HapticSession::forceShare() [-]
  double weakened = -1e30;     ///< when it was last below kWholeForce, steady clock [s]
  static constexpr double kWholeForce = 0.9;
  std::uint64_t input_stops = 0, snapshot_stops = 0;  ///< how often either was stale, since start
  double stopped = -1e30;                             ///< when the last of these began, steady clock [s]

  /// Records the result of a tick.
  void note(HapticStatus now, const Wrench& sent, double share_now = 1.0) {
    const auto stale = [](HapticStatus s) {
      return s == HapticStatus::PoseStale || s == HapticStatus::ForceStale;
    };
    const bool input_stops_now = stale(now) && !stale(status);
    // After a pause the last snapshot is old until the first step.
    const bool snapshot_stops_now =
        now == HapticStatus::SnapshotStale && status != now && status != HapticStatus::Paused;
    input_stops += input_stops_now;
    snapshot_stops += snapshot_stops_now;
    if (input_stops_now || snapshot_stops_now) stopped = steadyNow();
    status = now;
    force = sent.force;
    torque = sent.torque;
    share = share_now;
    if (share < kWholeForce) weakened = steadyNow();
  }
};

/// One probe: its session, by which haptic and solver thread close the loop, and what the messages of its
/// device bring.
struct SharedProbe {
  /// @param number of the probe in the scene
  SharedProbe(const NodeOptions& options, std::size_t number);

  ProbeSession& session() { return impedance ? static_cast<ProbeSession&>(*impedance) : *admittance; }

  std::optional<HapticSession> impedance;       ///< of one of the two kinds of device
  std::optional<AdmittanceSession> admittance;  ///< of the other
  Mailbox<StampedPose> pose;                    ///< pose callback → haptic thread
  Mailbox<StampedForce> force;                  ///< force callback → haptic thread; admittance devices
  Mailbox<FeltForce> felt;                      ///< haptic thread → display thread
  /// The device sends poses, good or bad. Pose callback → haptic thread; admittance devices.
  std::atomic<bool> sends_poses{false};
};

/// Target pose of an obstacle.
struct ObstacleTarget {
  std::uint64_t number = 0;  ///< counts up; 0: none yet
  Pose pose;
};

/// Outcome of requests to change options.
struct LiveReport {
  std::uint64_t taken = 0, refused = 0;  ///< since start
  bool refused_last = false;
  std::string refusal;  ///< of the last one that was refused; empty: none yet
};

struct SharedState {
  explicit SharedState(const NodeOptions& options);

  std::deque<SharedProbe> probes;                  ///< in the scene's order
  std::vector<Mailbox<ObstacleTarget>> obstacles;  ///< pose callback → solver thread, in the scene's order

  Mailbox<DisplayFrame> frame;        ///< solver thread → display thread
  Mailbox<SolverStats> solver_stats;  ///< solver thread → display thread
  Mailbox<HapticStats> haptic_stats;  ///< haptic thread → display thread

  SolverTasks tasks;                      ///< services → solver thread
  Mailbox<LiveOptions> live_for_haptics;  ///< service callback → haptic thread
  Mailbox<LiveOptions> live_for_solver;   ///< service callback → solver thread
  Mailbox<LiveOptions> live_for_poses;    ///< service callback → pose callbacks, which share a thread
  Mailbox<LiveOptions> live_for_display;  ///< service callback → display thread
  Mailbox<LiveReport> live_report;        ///< service callback → display thread

  std::atomic<bool> stop{false};
  std::atomic<bool> paused{false};
  std::atomic<bool> recording;  ///< a recording was asked for and has not ended
  std::atomic<bool> frame_wanted{true};
};

}  // namespace haptic_cloth
