/// Watches the energy that leaves through the device and takes back what should not have come out.
#pragma once

#include <array>

#include "haptic_cloth/types.h"

namespace haptic_cloth {

/// Of the passivity observer and controller.
struct PassivityOptions {
  double damping = 2.0;  ///< most that the controller adds [N·s/m]
  double debt = 5e-4;    ///< of energy at which the coupling is left half of its force [J]; 0: all of it
  double store = 0.05;   ///< most energy put into the cloth earlier that may come out again [J]
  double device_damping = 0.5;  ///< of mechanism and hand, which may be counted on [N·s/m]
  double loop_delay = 0.001;  ///< from a force leaving to a pose that has felt it, beyond the tick's own [s]
};

/// What could come out again at a pose [J]: of the coupling's spring, known exactly, and of the cloth.
struct HeldEnergy {
  double coupling = 0.0, cloth = 0.0;
};

/// Time-domain passivity observer and controller of one probe's device port [Hannaford & Ryu 2002], impedance
/// causality: E = -Σ f·Δx over the device's path is what the hand has put in; where it falls below zero the
/// loop has made energy, and f gets -α v until that is paid back. A virtual wall, a held force and a slow
/// solver all may make energy; a buzz lives on it.
///
/// E is kept at most at what coupling and cloth hold and can give back. Without that bound friction would
/// fill the store in a long contact and a later buzz would live on it for long.
class PassivityController {
 public:
  /// @param period of the ticks [s]
  PassivityController(const PassivityOptions& options, double period);

  /// Takes in a device position [m] and what is held there; once a tick, before damping().
  void observe(const Vec3& position, const HeldEnergy& held);

  /// Force to add [N] to pay back what is owed; zero where nothing is.
  Vec3 damping() const;

  /// Factor of the coupling's force: 1 where nothing was owed for long, a half at a debt of
  /// PassivityOptions::debt. It falls at once and rises slowly: else it would swing with the buzz and feed
  /// it.
  double gain() const { return gain_; }

  /// The force that was sent to the device in this tick [N].
  void sent(const Vec3& force);

  /// Lets a debt fade; once a tick where nothing is touched. A bounce is too short for much of that.
  void forgive();

  /// Other options from now on; what was put in and owed stays.
  /// @param unit of force and energy from now on, over that until now
  void setOptions(const PassivityOptions& options, double period, double unit);

  /// Forgets everything, debts too, as after a fault: what is held at the next observe() counts as put in.
  void reset();

  double energy() const { return energy_; }  ///< put in by the hand and not given back [J]; < 0: owed
  const Vec3& velocity() const { return velocity_; }  ///< of the device, over kWindow ticks [m/s]

 private:
  static constexpr int kForces = 64;  ///< ticks of forces that are remembered
  static constexpr int kWindow = 4;   ///< ticks over which speed is measured

  Vec3 forceFelt() const;

  PassivityOptions options_;
  double period_;
  std::array<Vec3, kForces> forces_;
  std::array<Vec3, kWindow + 1> positions_;
  int force_count_ = 0, position_count_ = 0;  ///< ever written
  double energy_ = 0.0, gain_ = 1.0;
  Vec3 velocity_ = Vec3::Zero();
};

}  // namespace haptic_cloth
