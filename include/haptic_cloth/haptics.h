/// Force for the newest pose of the device at each tick, however slow the solver is.
#pragma once

#include <array>
#include <atomic>
#include <string>

#include "haptic_cloth/admittance.h"
#include "haptic_cloth/passivity.h"
#include "haptic_cloth/types.h"

namespace haptic_cloth {

/// Force and torque on a probe, about its origin.
struct Wrench {
  Vec3 force = Vec3::Zero();   ///< [N]
  Vec3 torque = Vec3::Zero();  ///< [N·m]
};

/// Result of a step for the haptic thread. All times are on one steady clock [s].
struct ProbeSnapshot {
  double taken = -1.0;            ///< when the snapshot was published; < 0: none yet
  double device_received = -1.0;  ///< when the device was where it was solved for
  Vec3 device = Vec3::Zero();     ///< [m]
  Vec3 proxy = Vec3::Zero();      ///< [m]
  Quat device_orientation = Quat::Identity();
  Quat proxy_orientation = Quat::Identity();
  /// Radius at which the coupling resists turns [m]; 0: the probe has the orientation of its device.
  double turn_radius = 0.0;
  /// Motion of the proxy where the device stands, in wall-clock time: velocity, and angular velocity times
  /// turn_radius [m/s].
  Vec6 drift = Vec6::Zero();
  /// dProxy/dDevice, of positions and of turns times turn_radius. Symmetric; 0: a wall, 1: nothing
  /// resists [-].
  Mat6 follow = Mat6::Zero();
  Vec3 force = Vec3::Zero();   ///< on the probe at that solve [N]
  Vec3 torque = Vec3::Zero();  ///< on the probe about its proxy at that solve [N·m]
  bool contact = false;
  bool holds = false;           ///< the probe holds cloth
  bool inside = false;          ///< see ProbeReport
  Vec3 way_out = Vec3::Zero();  ///< see ProbeReport [-]
  /// Share of the wrench to pass on: below 1 while the estimated error of the force exceeds the force [-].
  double trust = 1.0;
  int cloth = 0;  ///< number of restarts of the probe: jumps, resets, loaded states
};

/// A device pose as received.
struct DeviceSample {
  double received = -1.0;                ///< steady clock [s]; < 0: none yet
  Vec3 position = Vec3::Zero();          ///< in the cloth's frame [m]
  Vec3 velocity = Vec3::Zero();          ///< filtered [m/s]
  Quat orientation = Quat::Identity();   ///< in the cloth's frame; see DeviceState
  Vec3 angular_velocity = Vec3::Zero();  ///< filtered [rad/s]
  int returns = 0;  ///< how often it came back after a silence of HapticOptions::probe_timeout
};

/// Newest-value mailbox for one writer and one reader, wait-free on both sides (three slots).
template <class T>
class Mailbox {
 public:
  /// Writer: replaces the value.
  void write(const T& value) {
    slots_[write_] = value;
    write_ = shared_.exchange(write_ | kFresh, std::memory_order_acq_rel) & kIndex;
  }
  /// Reader: the newest value; the reference stays valid until the next read().
  const T& read() {
    if (shared_.load(std::memory_order_relaxed) & kFresh) {
      read_ = shared_.exchange(read_, std::memory_order_acq_rel) & kIndex;
    }
    return slots_[read_];
  }

 private:
  static constexpr unsigned kFresh = 4, kIndex = 3;
  std::array<T, 3> slots_{};
  unsigned write_ = 0, read_ = 1;
  std::atomic<unsigned> shared_{2};
};

/// Limits of what the hand may feel. Defaults suit a small desktop device.
struct HapticOptions {
  double rate = 1000.0;           ///< ticks a second [Hz]
  double max_force = 3.3;         ///< [N]
  double max_force_rate = 200.0;  ///< largest change of the force [N/s]
  /// [N·m]; 0: no torque. It takes as long from zero to its limit as the force does at
  /// max_force_rate.
  double max_torque = 0.1;
  double soft_start = 0.5;        ///< the limit rises from zero in this time after start, pause and fault [s]
  double pose_timeout = 0.05;     ///< an older device pose ramps the force to zero [s]
  double snapshot_timeout = 0.1;  ///< an older snapshot ramps the force to zero [s]
  double ramp_time = 0.02;        ///< from full force to zero [s]
  double probe_timeout = 1.0;     ///< without poses or forces this long the probe leaves the scene [s]
  double velocity_time_constant = 0.005;  ///< low-pass filter of the device's velocity [s]
  PassivityOptions passivity;
  AdmittanceOptions admittance;       ///< for devices of that kind
  double coupling_stiffness = 400.0;  ///< [N/m], the scene's
  double coupling_damping = 1.0;      ///< [N·s/m], the scene's
};

/// Checks every option. @param origin names the source in messages.
/// @throws InputError naming the option, its value and the rule.
void validateHapticOptions(const HapticOptions& options, const std::string& origin);

/// State of the haptic tick. The force is on only in Contact; every other value says why it is zero.
/// NoForce and ForceStale belong to admittance devices. NoSnapshot also means that the device has
/// jumped away from the place of the snapshot. Inside: the probe appeared in the cloth, and touches nothing
/// until it has been clear of it once.
enum class HapticStatus {
  NoPose,
  NoForce,
  NoSnapshot,
  PoseStale,
  ForceStale,
  SnapshotStale,
  Paused,
  Inside,
  Free,
  Contact
};

/// Short name of a status for logs and diagnostics ("contact", ...).
const char* toString(HapticStatus status);

/// Tells whether pose and snapshot are good, so that a force may act.
bool allowsForce(HapticStatus status);

struct HeldEnergies;

/// The haptic tick of one probe: pure arithmetic on its own state, no clock, no lock, no allocation.
class HapticLoop {
 public:
  /// @throws InputError if an option is not valid
  explicit HapticLoop(const HapticOptions& options);

  /// Computes the force on the probe [N] in the cloth's frame for the newest pose at `now` (steady
  /// clock [s]). It is always finite, at most max_force, and changes by at most max_force_rate. It
  /// ramps to exactly zero during a pause, and if an input is stale or not finite or the device has
  /// jumped away from the snapshot's position, or from its orientation where a coupling turns the probe.
  /// Without contact in the snapshot it is zero. torque() then returns the torque, limited and ramped in the
  /// same way.
  Vec3 tick(const DeviceSample& device, const ProbeSnapshot& snapshot, bool paused, double now);

  /// Takes other options from the next tick on. The force continues within max_force_rate.
  /// @param unit new unit of force and torque over the old one, so that the hand feels no jump when
  /// the scale between hand and probe changes [-]
  /// @pre the options are valid
  void setOptions(const HapticOptions& options, double unit = 1.0);

  HapticStatus status() const { return status_; }

  /// Torque on the probe about its origin at the last tick [N·m], in the cloth's frame.
  const Vec3& torque() const { return wrench_.torque; }

  /// Energy that the hand has put in and not got back [J]; < 0: energy that the loop made and owes.
  double energy() const { return passivity_.energy(); }

  /// Share of the coupling's force that was passed on at the last tick [-]; 1: nothing is owed and the force
  /// is trusted, or no contact.
  double forceShare() const { return status_ == HapticStatus::Contact ? gains().force : 1.0; }

 private:
  /// Energy by forces and by torques [J].
  struct Energy {
    double by_force = 0.0, by_torque = 0.0;
    double all() const { return by_force + by_torque; }
  };
  /// Factors by which debts, and a lack of trust, weaken force and torque [-].
  struct Gains {
    double force, torque;
  };

  Wrench contactWrench(const DeviceSample& device, const ProbeSnapshot& snapshot, double now);
  Wrench handedOver(const DeviceSample& device, const ProbeSnapshot& snapshot, const Wrench& wrench,
                    double now);
  double torqueRate(double force_rate);
  Wrench withinLimits(const Wrench& wrench) const;
  Energy takenSince(const ProbeSnapshot& solve, const Pose& place, const Wrench& wrench) const;
  Gains gains() const;
  void observe(const DeviceSample& device, const HeldEnergies& held, const Energy& taken, double trust);

  HapticOptions options_;
  PassivityController passivity_;         ///< of the force
  PassivityController torque_passivity_;  ///< of the torque
  double trust_ = 1.0;                    ///< see ProbeSnapshot
  Quat orientation_ = Quat::Identity();   ///< of the device at the last tick
  Vec3 turned_ = Vec3::Zero();            ///< all turns of the device so far [rad]
  ProbeSnapshot snapshot_;                ///< of the last tick
  /// Energy that coupling and cloth have taken by the solver's account, as if no force had been weakened:
  /// until the solve of that snapshot, and until the last tick.
  Energy taken_, taken_before_;
  Energy recovered_;             ///< that a gain which recovers lets the spring give more back
  double limit_ = 0.0;           ///< of the force at the last tick with contact [N]
  Wrench handover_;              ///< wrench of the last snapshot minus that of the newest
  double handover_start_ = 0.0;  ///< steady clock [s]
  double handover_time_ = 0.0;   ///< time in which it fades [s]
  HapticStatus status_ = HapticStatus::NoPose;
  Wrench wrench_;             ///< of the last tick
  double torque_span_ = 0.0;  ///< max_torque, or more until a lowered one is reached [N·m]
  double last_tick_ = -1.0;
  double soft_ = 0.0;  ///< 0..1, progress of the soft start
};

}  // namespace haptic_cloth
