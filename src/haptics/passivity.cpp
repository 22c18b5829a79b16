#include "haptic_cloth/passivity.h"

#include <algorithm>
#include <cmath>
#include <limits>

namespace haptic_cloth {
namespace {

constexpr double kMostDebt = 1.0;    ///< more than a device with a hand on it has in motion [J]
constexpr double kForgetting = 1.0;  ///< of a debt where nothing is touched [s]

/// Time in which the cloth's share of the bound falls to 1/e [s]. For a few ticks after cells have split, the
/// local model may be several times too stiff. With 20 ms a falcon buzzes after a stall.
constexpr double kFall = 0.005;

/// Return of the whole force when nothing is owed any more [s]. Among 0, 10, 20, 30 ms the one at which
/// nothing buzzes in test/stability; from 0.1 s on slow swings take the buzz's place.
constexpr double kRecovery = 0.02;

/// A device that stays within this distance of a place, which may drift, is at rest [m]: above the quantum of
/// position of the devices in test/stability, below the swings that are felt as a buzz there.
constexpr double kRestRadius = 1e-4;

/// A hand that yields to the returning force moves no faster [m/s]. A buzz of 0.15 mm does, from 5 Hz on.
constexpr double kDrift = 2e-3;

constexpr double kReturn = 2.0;        ///< of a debt to 1/e where the device rests [s]
constexpr double kFirstWait = 0.25;    ///< shortest time at rest after which a debt fades [s]
constexpr double kLongestWait = 60.0;  ///< and the longest [s]
constexpr double kLongerWait = 4.0;    ///< factor for the wait of a debt that has grown again [-]
constexpr double kGrowth = 0.1;        ///< share of the remaining force that a grown debt has taken [-]

}  // namespace

PassivityController::PassivityController(const PassivityOptions& options, double period)
    : options_(options), period_(period) {
  reset();
}

void PassivityController::reset() {
  forces_.clear();
  places_.clear();
  // Energy held where the next contact begins may come out: after a fault the wall pushes the hand back out.
  by_hand_ = by_loop_ = std::numeric_limits<double>::infinity();
  cloth_ = 0.0;
  gain_ = 1.0;
  velocity_ = Vec6::Zero();
  rested_ = fading_ = 0.0;
  wait_ = kFirstWait;
  is_fading_ = false;
}

void PassivityController::setOptions(const PassivityOptions& options, double period, double unit) {
  options_ = options;
  for (double* energy : {&by_hand_, &by_loop_, &cloth_, &fading_}) *energy /= unit;
  for (int age = 0; age < forces_.size(); ++age) forces_[age] /= unit;
  if (period == period_) return;
  period_ = period;
  places_.clear();  // speed is measured over ticks of one length
}

/// Force that pushed the device between the last two poses [N]: the force of the tick in which the first
/// came, or of earlier ones where the way there and back takes time.
Vec6 PassivityController::forceFelt() const {
  const double back = std::min(options_.loop_delay / period_, kForces - 2.0);
  const int whole = static_cast<int>(back);
  const double share = back - whole;
  const auto sentBefore = [this](int ticks) {
    return ticks < forces_.size() ? forces_[ticks] : Vec6(Vec6::Zero());
  };
  return (1.0 - share) * sentBefore(whole) + share * sentBefore(whole + 1);
}

void PassivityController::observe(const Vec6& place, const HeldEnergy& held, double passed) {
  if (places_.size() > 0) {
    const double given = forceFelt().dot(place - places_[0]);
    by_hand_ -= given;
    by_loop_ -= given + passed;
  }
  places_.add(place);
  const int window = places_.size() - 1;
  velocity_ = window > 0 ? Vec6((place - places_[window]) / (window * period_)) : Vec6(Vec6::Zero());
  const double damped = options_.device_damping * velocity_.head<3>().squaredNorm() * period_;
  const double fallen = held.cloth > 0.0 ? cloth_ * std::exp(-period_ / kFall) : 0.0;
  cloth_ = std::min(options_.store, std::max(fallen, held.cloth));
  for (double* energy : {&by_hand_, &by_loop_})
    *energy = std::clamp(*energy + damped, -kMostDebt, held.coupling + cloth_);
  fadeAtRest(place);
  const double wanted = std::max(gainAt(-by_hand_, 0.0), gainAt(-by_loop_, held.scaled));
  gain_ = std::min({1.0, wanted, gain_ + period_ / kRecovery});
}

/// Gain at a debt, more than 1 where something is left [-]. A lower gain takes energy from the spring that it
/// scales, which pays a part of the debt. The gain is the one at which both agree:
/// gain = d / (d + debt + (gain - gain_) spring) with d = PassivityOptions::debt. If the payment came a tick
/// later, the gain would swing between too low and too high.
double PassivityController::gainAt(double debt, double spring) const {
  if (options_.debt == 0.0) return 1.0;
  const double half = 0.5 * (options_.debt + debt - gain_ * spring);
  return options_.debt / (half + std::sqrt(half * half + spring * options_.debt));
}

/// α pays the debt within one tick, but is at most what the device bears: at rest, where the speed is a
/// quantum of position now and then, the force stays that of a small damper.
Vec6 PassivityController::damping() const {
  const double squared = velocity_.squaredNorm();
  if (energy() >= 0.0 || squared == 0.0) return Vec6::Zero();
  const double wanted = -energy() / (squared * period_);
  return -std::min(options_.damping, wanted) * velocity_;
}

void PassivityController::forgive() {
  wait_ = std::max(kFirstWait, wait_ * std::exp(-period_ / kForgetting));
  fade();
}

/// Nothing pays a debt where hand and cloth rest, so it fades there. Meanwhile, what the returning force
/// gives a hand that yields to it does not count. A debt that has grown since it last faded, as by a buzz
/// that the force has woken, waits four times as long.
void PassivityController::fadeAtRest(const Vec6& place) {
  const double distance = (place - resting_place_).norm();
  const bool moves = distance > kRestRadius;
  const double drift = moves ? 1.0 : std::min(1.0, kDrift * period_ / std::max(distance, 1e-300));
  resting_place_ += drift * (place - resting_place_);
  rested_ = moves ? 0.0 : rested_ + period_;
  is_fading_ = is_fading_ && !moves;
  if (rested_ < wait_) return;
  const double debt = std::max(0.0, -energy());
  if (!is_fading_ && debt > fading_ + kGrowth * (options_.debt + debt)) {
    fading_ = debt;
    wait_ = std::min(kLongestWait, kLongerWait * wait_);
    rested_ = 0.0;
    return;
  }
  is_fading_ = fading_ > kGrowth * options_.debt;
  if (!is_fading_) return fade();
  fading_ *= std::exp(-period_ / kReturn);
  for (double* energy : {&by_hand_, &by_loop_}) *energy = std::max(*energy, -fading_);
}

void PassivityController::fade() {
  for (double* energy : {&by_hand_, &by_loop_}) {
    if (*energy < 0.0) *energy *= std::exp(-period_ / kForgetting);
  }
}

void PassivityController::sent(const Vec6& force) { forces_.add(force); }

}  // namespace haptic_cloth
