/// A hand holding a device that touches a simulated world: the whole haptic loop without hardware.
#pragma once

#include <ostream>
#include <string>
#include <vector>

#include "haptic_cloth/haptics.h"
#include "haptic_cloth/report.h"

namespace haptic_cloth {

/// The mechanism and what lies between it and the haptic thread.
struct DeviceModel {
  double mass = 0.1;      ///< felt at the grip [kg]
  double damping = 0.5;   ///< of the mechanism [N·s/m]
  double quantum = 3e-5;  ///< of the measured position [m]
  double noise = 0.0;     ///< uniform, to either side, before quantising [m]
  double delay = 0.0;     ///< half on the way in, half on the way out [s]
  double dies_at = 1e9;   ///< no pose arrives any more [s]
};

/// The hand pulls to a target that goes into the wall, waits, and slides along it.
struct HandModel {
  double stiffness = 300.0;                                      ///< [N/m]
  double damping = 2.0;                                          ///< [N·s/m]
  Vec3 start = Vec3(0, 0, 0.005), pressed = Vec3(0, 0, -0.006);  ///< [m]
  double press_from = 0.05, press_time = 0.2;                    ///< [s]
};

/// What the solver solves.
class ProbeWorld {
 public:
  virtual ~ProbeWorld() = default;
  /// One step with the device there.
  virtual ProbeReport solve(const Vec3& device, const Vec3& device_velocity) = 0;
};

/// A wall z < 0 behind the virtual coupling: rigid, or elastic along z. Free along x and y.
class WallWorld : public ProbeWorld {
 public:
  /// @param coupling of the probe [N/m]  @param stiffness of the wall [N/m]
  WallWorld(double coupling, double stiffness) : follow_(coupling / (coupling + stiffness)) {}
  ProbeReport solve(const Vec3& device, const Vec3& device_velocity) override;

 private:
  double follow_;
  bool known_ = false;
  Vec3 proxy_ = Vec3::Zero();
};

/// When the solver's steps end.
struct SolverModel {
  double time_step = 1e-3;                    ///< [s]
  double slowness = 1.0;                      ///< wall-clock time of a step over time_step
  double stall_from = 1e9, stall_time = 0.0;  ///< no step ends then [s]
};

struct LoopResult {
  double amplitude = 0.0;     ///< half of the device's peak-to-peak in the last part of the run [m]
  double force_ripple = 0.0;  ///< the same of the force on the hand [N]
  double generated = 0.0;     ///< by the force on the device over that part [J]
  double mean_force = 0.0;    ///< norm of the mean force over that part [N]
  double most_force = 0.0;    ///< over the run [N]
  double most_change = 0.0;   ///< from tick to tick [N]
  double force_at_end = 0.0;  ///< [N]
  double zero_since = 1e9;    ///< the force is exactly zero from here to the end [s]
  bool finite = true;
};

struct LoopRun {
  HapticOptions options;
  DeviceModel device;
  HandModel hand;
  SolverModel solver;
  double time = 1.2;      ///< [s]
  double measured = 0.4;  ///< of it, at the end [s]
};

/// The device's motion in steps of 50 µs, the tick and the solver at their own rates.
LoopResult runLoop(const LoopRun& run, ProbeWorld& world);

/// What a device may render by its maker's data sheet. The Falcon's gives no damping; half of the omega's is
/// taken. Masses are round figures of the size that [Diolaiti et al. 2006] and others measured.
struct PublishedDevice {
  std::string name;
  double max_force;   ///< [N]
  double stiffness;   ///< largest closed-loop stiffness [N/m]
  double damping;     ///< largest virtual damping [N·s/m]
  double mass;        ///< apparent at the tip [kg]
  double resolution;  ///< [m]
};

std::vector<PublishedDevice> publishedDevices();

/// For gtest's reports.
inline void PrintTo(const PublishedDevice& device, std::ostream* stream) { *stream << device.name; }

}  // namespace haptic_cloth
