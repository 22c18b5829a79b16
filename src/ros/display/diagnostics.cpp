#include "ros/display/diagnostics.h"

#include <array>
#include <cstdio>
#include <utility>

#include "haptic_cloth/machine.h"
#include "state/number_text.h"

namespace haptic_cloth {
namespace {

using diagnostic_msgs::DiagnosticStatus;

constexpr double kHanging = 2.0;        ///< older statistics mean that the thread hangs [s]
constexpr double kRateShare = 0.9;      ///< share of the wanted rate that is good enough [-]
constexpr double kLatenessGood = 1e-3;  ///< 99 % of the ticks must be less late than this [s]
constexpr double kNow = 0.5;            ///< longest interval between good messages [s]
constexpr double kLately = 5.0;         ///< time for which a past fault remains a warning [s]
constexpr double kMostSlip = 0.05;      ///< share of the time that may slip [-]
constexpr double kTransformAge = 1.0;   ///< older transforms are doubtful [s]
constexpr double kMoving = 2.0;         ///< longest interval between the poses of a moving obstacle [s]
constexpr char kBadTurn[] = "quaternions that are not of length 1";

void add(DiagnosticStatus& status, const std::string& key, const std::string& value) {
  diagnostic_msgs::KeyValue entry;
  entry.key = key;
  entry.value = value;
  status.values.push_back(entry);
}

void add(DiagnosticStatus& status, const std::string& key, double value) {
  char text[32];
  std::snprintf(text, sizeof text, "%.4g", value);
  add(status, key, std::string(text));
}

void add(DiagnosticStatus& status, const std::string& key, std::uint64_t value) {
  add(status, key, std::to_string(value));
}

void judge(DiagnosticStatus& status, int level, const std::string& message) {
  status.level = static_cast<DiagnosticStatus::_level_type>(level);
  status.message = message;
}

std::string seconds(double time) { return shortestText(time) + " s"; }

using DropReason = std::pair<const char*, const std::atomic<std::uint64_t>*>;

const char* failureText(Termination why) {
  if (why == Termination::OutOfReach)
    return "a step failed: parts of the cloth may have met unseen, so it stopped where it was";
  return "a step failed: its result was not finite; the last good state was restored";
}

/// Reasons for dropping messages, each with its counter.
std::array<DropReason, 6> dropReasons(const InputCounters& counters) {
  return {DropReason{"not finite", &counters.not_finite}, {"unknown frame", &counters.unknown_frame},
          {"out of order", &counters.out_of_order},       {"late", &counters.late},
          {"other sender", &counters.other_sender},       {"too far", &counters.too_far}};
}

std::array<DropReason, 3> dropReasons(const DropCounters& counters) {
  return {DropReason{"not finite", &counters.not_finite},
          {"unknown frame", &counters.unknown_frame},
          {"too far", &counters.too_far}};
}

/// How many messages were dropped, and why the last one. @pre one was
template <class Counters>
std::string dropText(const Counters& counters, const std::string& message) {
  std::string why = "unknown";
  const auto* const last = counters.last_counter.load();
  for (const auto& [reason, counter] : dropReasons(counters)) {
    if (counter == last) why = reason;
  }
  return std::to_string(counters.dropped()) + " " + message + "s dropped, the last: " + why;
}

template <class Counters>
void add(DiagnosticStatus& status, const std::string& prefix, const Counters& counters) {
  add(status, prefix + "received", counters.received.load());
  add(status, prefix + "dropped", counters.dropped());
  for (const auto& [reason, counter] : dropReasons(counters)) {
    add(status, prefix + "dropped: " + reason, counter->load());
  }
}

const char* graspText(GraspState grasp) {
  switch (grasp) {
    case GraspState::Open:
      return "open";
    case GraspState::Closed:
      return "closed";
    case GraspState::Holding:
      return "holds cloth";
  }
  return "unknown";
}

}  // namespace

DiagnosticStatus solverStatus(const SolverStats& stats, bool paused, double now) {
  DiagnosticStatus status;
  status.name = "solver";
  if (paused) {
    judge(status, DiagnosticStatus::OK, "paused");
  } else if (stats.taken < 0.0 || now - stats.taken > kHanging) {
    judge(status, DiagnosticStatus::WARN, "no steps");
  } else if (now - stats.failed.when < kLately) {
    judge(status, DiagnosticStatus::WARN, failureText(stats.failed.why));
  } else {
    const std::string& given_up = stats.quality.given_up;
    const std::string running = given_up.empty() ? "running" : "running with " + given_up;
    if (stats.slipped_share > kMostSlip) {
      char text[64];
      std::snprintf(text, sizeof text, "too slow, %.0f %% of the time slips; ", 100.0 * stats.slipped_share);
      judge(status, DiagnosticStatus::WARN, text + running);
    } else {
      judge(status, DiagnosticStatus::OK, running);
    }
  }
  const bool stands = paused || !(stats.wall > 0.0);  // then there are no rates
  add(status, "steps per second", stands ? 0.0 : stats.steps / stats.wall);
  add(status, "real-time factor", stands ? 0.0 : stats.real_time_factor);
  add(status, "simulated time [s]", stats.time);
  add(status, "quality rung", static_cast<std::uint64_t>(stats.quality.rung));
  add(status, "given up", stats.quality.given_up.empty() ? std::string("nothing") : stats.quality.given_up);
  add(status, "step length [s]", stats.quality.step_length);
  add(status, "slipped [s]", stats.quality.slipped);
  add(status, "active particles", static_cast<std::uint64_t>(stats.last.active_particles));
  add(status, "iterations per step", stats.iterations);
  add(status, "termination", std::string(toString(stats.last.minimizer.why)));
  add(status, "residual [|g|]", stats.last.minimizer.residual);
  add(status, "failed steps", stats.failed.count);
  add(status, "failed: parts may have met", stats.failed.out_of_reach);
  add(status, "steps made in part", stats.failed.made_in_part);
  add(status, "self-contact", std::string(stats.meets_itself ? "on" : "off: layers pass through each other"));
  add(status, "contacts between layers", static_cast<std::uint64_t>(stats.last.self_contacts));
  add(status, "smallest gap of layers [mm]", 1e3 * stats.last.min_self_gap);
  add(status, "kinetic energy [J]", stats.kinetic);
  static const std::string processor = processorName();  // reads a file once
  add(status, "processor", processor);
  add(status, "instruction set", std::string(instructionSet()));
  return status;
}

DiagnosticStatus hapticStatus(const HapticStats& stats, const std::string& scheduling, double now) {
  const double measured = stats.wall > 0.0 ? stats.ticks / stats.wall : 0.0;
  DiagnosticStatus status;
  status.name = "haptic thread";
  if (stats.taken < 0.0) {
    judge(status, DiagnosticStatus::OK, "starting");
  } else if (now - stats.taken > kHanging) {
    judge(status, DiagnosticStatus::ERROR, "no ticks");
  } else if (measured < kRateShare * stats.rate || stats.lateness.quantile(0.99) > kLatenessGood) {
    judge(status, DiagnosticStatus::WARN, "late; " + scheduling);
  } else {
    judge(status, DiagnosticStatus::OK, scheduling);
  }
  add(status, "rate [Hz]", measured);
  add(status, "late p50 [us]", 1e6 * stats.lateness.quantile(0.5));
  add(status, "late p99 [us]", 1e6 * stats.lateness.quantile(0.99));
  add(status, "late max [us]", 1e6 * stats.lateness.max());
  add(status, "ticks given up", stats.given_up);
  add(status, "scheduling", scheduling);
  return status;
}

DiagnosticStatus optionsStatus(const LiveReport& report) {
  DiagnosticStatus status;
  status.name = "options";
  judge(status, report.refused_last ? DiagnosticStatus::WARN : DiagnosticStatus::OK,
        report.refused_last ? "refused: " + report.refusal
        : report.taken > 0  ? "changed live"
                            : "as started");
  add(status, "changes accepted", report.taken);
  add(status, "changes refused", report.refused);
  add(status, "last refusal", report.refusal);
  return status;
}

DiagnosticStatus probeStatus(const std::string& name, const DeviceCounters& counters, const FeltForce& felt,
                             GraspState grasp, double force_error, double now, const std::string& others) {
  DiagnosticStatus status;
  status.name = name;
  const InputCounters& poses = counters.poses;
  // What the device sends at haptic rate.
  const InputCounters& input = counters.forces != nullptr ? *counters.forces : poses;
  const std::string message = counters.forces != nullptr ? "force" : "pose";
  const UnitDoubt doubt = poses.doubt;
  const bool no_pose = felt.status == HapticStatus::NoPose || felt.status == HapticStatus::PoseStale;
  const bool stale =
      no_pose || felt.status == HapticStatus::NoForce || felt.status == HapticStatus::ForceStale;
  const std::string and_so = stale ? "; no force" : "";
  const auto dropsNow = [&](const InputCounters& of) {
    return of.dropped() > 0 && now - of.last_dropped < (stale ? kNow : kLately);
  };
  if (input.received == 0 && !dropsNow(poses)) {
    judge(status, DiagnosticStatus::OK, "no " + message + " yet");
  } else if (felt.status == HapticStatus::SnapshotStale) {
    judge(status, DiagnosticStatus::WARN, "the solver stalls; no force");
  } else if (felt.status == HapticStatus::Inside) {
    judge(status, DiagnosticStatus::WARN, "the probe appeared in the cloth; move it clear of it once");
  } else if (dropsNow(input)) {
    judge(status, DiagnosticStatus::WARN, dropText(input, message) + and_so);
  } else if (dropsNow(poses)) {
    judge(status, DiagnosticStatus::WARN, dropText(poses, "pose") + and_so);
  } else if (stale) {
    judge(status, DiagnosticStatus::WARN,
          std::string("the ") + (no_pose ? "pose" : "force") + "s stopped; no force");
  } else if (felt.status == HapticStatus::Paused) {
    judge(status, DiagnosticStatus::OK, "paused");
  } else if (doubt != UnitDoubt::None) {
    judge(status, DiagnosticStatus::WARN, toText(doubt));
  } else if (now - felt.stopped < kLately) {
    judge(status, DiagnosticStatus::WARN, "the force was off within the last " + seconds(kLately));
  } else if (poses.transform_age > kTransformAge) {
    judge(status, DiagnosticStatus::WARN, "the transform of the device's frame is old");
  } else if (now - poses.bad_turn < kLately) {
    judge(status, DiagnosticStatus::WARN, std::string(kBadTurn) + "; the probe does not turn");
  } else if (now - felt.weakened < kLately) {
    judge(status, DiagnosticStatus::WARN,
          "the force was weakened, against a buzz or for its error, within the last " + seconds(kLately));
  } else {
    judge(status, DiagnosticStatus::OK, "receiving");
  }
  if (!others.empty()) {
    const std::string too = status.level == DiagnosticStatus::OK ? "" : "; " + status.message;
    judge(status, DiagnosticStatus::WARN, "the device also gets messages of " + others + too);
  }
  add(status, "status", std::string(toString(felt.status)));
  add(status, "force [N]", felt.force.norm());
  add(status, "error of the force, estimated [N]", force_error);
  add(status, "share of the force passed on [%]", 100.0 * felt.share);
  add(status, "torque [N m]", felt.torque.norm());
  add(status, "grasp", std::string(graspText(grasp)));
  add(status, "", input);
  if (counters.forces != nullptr) add(status, "poses ", poses);
  add(status, "force off: " + message + "s stopped", felt.input_stops);
  add(status, "force off: solver stalled", felt.snapshot_stops);
  add(status, "units", std::string(doubt == UnitDoubt::None ? "plausible" : toText(doubt)));
  add(status, "taken: bad quaternion", poses.bad_quaternion.load());
  add(status, "age of the transform [s]", poses.transform_age.load());
  add(status, "other publishers", others.empty() ? std::string("none") : others);
  return status;
}

DiagnosticStatus obstacleStatus(const std::string& name, const DropCounters& counters, double now) {
  DiagnosticStatus status;
  status.name = "obstacle " + name;
  const bool moves = now - counters.last_received < kMoving;
  if (counters.dropped() > 0 && now - counters.last_dropped < kLately) {
    judge(status, DiagnosticStatus::WARN, dropText(counters, "pose"));
  } else if (now - counters.bad_turn < kLately) {
    judge(status, DiagnosticStatus::WARN, std::string(kBadTurn) + "; the obstacle does not turn");
  } else {
    judge(status, DiagnosticStatus::OK,
          counters.received == 0 ? std::string("no pose yet")
          : moves                ? std::string("receiving")
                                 : "stands still: no pose for " + seconds(kMoving));
  }
  add(status, "", counters);
  add(status, "taken: bad quaternion", counters.bad_quaternion.load());
  return status;
}

DiagnosticStatus displayStatus(std::uint64_t marker_frames, std::uint64_t state_frames, bool master_reachable,
                               std::uint64_t registrations) {
  DiagnosticStatus status;
  status.name = "display";
  judge(status, master_reachable ? DiagnosticStatus::OK : DiagnosticStatus::WARN,
        master_reachable ? "running" : "ROS master lost; connected peers stay connected");
  add(status, "marker frames", marker_frames);
  add(status, "state frames", state_frames);
  add(status, "registrations renewed", registrations);
  return status;
}

}  // namespace haptic_cloth
