/// Passivity observer and controller: removes energy that the haptic loop has created.
#pragma once

#include <algorithm>
#include <array>
#include <cmath>

#include "haptic_cloth/types.h"

namespace haptic_cloth {

constexpr double kMostTickRate = 10000.0;  ///< highest rate of the haptic ticks [Hz]
constexpr double kMostLoopDelay = 0.1;     ///< longest PassivityOptions::loop_delay [s]

/// Options of the passivity observer and controller.
struct PassivityOptions {
  double damping = 2.0;  ///< largest damping that the controller adds [N·s/m]
  double debt = 5e-4;    ///< energy debt that halves the coupling's force [J]; 0: never weaken it
  double store = 0.05;   ///< largest energy put into the cloth earlier that may come out again [J]
  /// Damping of mechanism and hand that can be relied on; of turns none can [N·s/m].
  double device_damping = 0.5;
  /// Time from sending a force to the pose that responds to it, beyond the tick itself, at most
  /// kMostLoopDelay [s].
  double loop_delay = 0.001;
};

/// Energy that could come out again at a pose [J]: of the coupling's spring (exact) and of the
/// cloth.
struct HeldEnergy {
  double coupling = 0.0, cloth = 0.0;
  double scaled = 0.0;  ///< of the part of the spring whose force gain() scales
};

/// Time-domain passivity observer and controller for the device port of one probe [Hannaford & Ryu
/// 2002], impedance causality. x is the place of the device: its position, and its turns so far times a
/// radius; f is its force, and its torque over that radius. E = -Σ f·Δx over the path of the device is
/// the energy that the hand has put in. If E falls below zero, the loop has created energy, and -α v is added
/// to f until the debt is paid. A virtual wall, a held force or a slow solver may create energy, and a buzz
/// lives on it.
///
/// E is kept at or below the energy that coupling and cloth hold and can give back, or could 5 ms ago.
/// Otherwise friction would fill the store during a long contact and feed a later buzz.
///
/// Cloth may also give what the hand did not put in just before: a weight that is let down, the push of a
/// moving obstacle, the pull of friction on a ball that the hand turns. So a second account L counts the loop
/// alone: what the hand puts in minus what goes on into coupling and cloth, as the solver's forces say. A
/// force that is held or late lowers both. The debt is that of the higher one.
class PassivityController {
 public:
  /// @param period time between ticks [s], at least 1/kMostTickRate
  PassivityController(const PassivityOptions& options, double period);

  /// Records the place of the device [m] and the energy held there. Called once a tick, before damping().
  /// @param passed energy that has gone on into coupling and cloth since the last tick, by the solver's
  /// account [J]
  void observe(const Vec6& place, const HeldEnergy& held, double passed);

  /// Force that pays the debt [N]; zero if there is none.
  Vec6 damping() const;

  /// Factor for the coupling's force: 1 without debt, ½ at a debt of PassivityOptions::debt. It
  /// falls at once and rises slowly; otherwise it would swing with the buzz and feed it.
  double gain() const { return gain_; }

  /// Records the force sent to the device in this tick [N].
  void sent(const Vec6& force);

  /// Lets a debt fade. Called once a tick without contact. A bounce is too short for the debt to
  /// fade much. In contact a debt fades while the device rests, see fadeAtRest().
  void forgive();

  /// Changes the options; energy and debt stay.
  /// @param unit new unit of force and energy / old unit
  void setOptions(const PassivityOptions& options, double period, double unit);

  /// Forgets everything including debts, as after a fault. The energy held at the next observe()
  /// counts as put in.
  void reset();

  /// Energy put in by the hand and not given back [J]: the higher one of E and L; < 0: debt. Zero before the
  /// first observe() since the start or reset().
  double energy() const { return std::isfinite(by_hand_) ? std::max(by_hand_, by_loop_) : 0.0; }

  /// Velocity of the device over the last kWindow ticks [m/s].
  const Vec6& velocity() const { return velocity_; }

 private:
  /// Number of forces remembered: enough for the longest delay at the highest rate [ticks].
  static constexpr int kForces = static_cast<int>(kMostLoopDelay * kMostTickRate) + 2;
  static constexpr int kWindow = 4;  ///< span of the velocity measurement [ticks]

  /// The last N vectors. It may run for ever: it counts up to N.
  template <int N>
  class Last {
   public:
    void add(const Vec6& vector) {
      newest_ = (newest_ + 1) % N;
      vectors_[newest_] = vector;
      if (size_ < N) ++size_;
    }
    void clear() { size_ = 0; }
    int size() const { return size_; }
    /// @param age 0: the newest. @pre 0 <= age < size()
    Vec6& operator[](int age) { return vectors_[(newest_ - age + N) % N]; }
    const Vec6& operator[](int age) const { return vectors_[(newest_ - age + N) % N]; }

   private:
    std::array<Vec6, N> vectors_;
    int newest_ = 0, size_ = 0;
  };

  Vec6 forceFelt() const;
  double gainAt(double debt, double spring) const;
  void fadeAtRest(const Vec6& place);
  void fade();

  PassivityOptions options_;
  double period_;
  Last<kForces> forces_;                  ///< since the last reset
  Last<kWindow + 1> places_;              ///< since the last reset or change of the period
  double by_hand_ = 0.0, by_loop_ = 0.0;  ///< E and L; infinite until observe() bounds them [J]
  double gain_ = 1.0;
  double cloth_ = 0.0;  ///< share of the cloth in the bound of E and L [J]
  Vec6 velocity_ = Vec6::Zero();
  Vec6 resting_place_ = Vec6::Zero();  ///< follows the device slowly, or at once where that moves
  double rested_ = 0.0;                ///< time at rest [s]
  double wait_ = 0.0;                  ///< time at rest after which a debt fades [s]
  double fading_ = 0.0;                ///< debt that fades at rest, and may go on after a motion [J]
  bool is_fading_ = false;
};

}  // namespace haptic_cloth
