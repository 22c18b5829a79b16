#include "haptic_cloth/passivity.h"

#include <algorithm>
#include <cmath>
#include <limits>

namespace haptic_cloth {
namespace {

constexpr double kMostDebt = 1.0;    ///< more than a device with a hand on it has in motion [J]
constexpr double kForgetting = 1.0;  ///< of a debt where nothing is touched or the device rests [s]

/// Time in which the cloth's share of the bound falls to 1/e [s]. For a few ticks after cells have split, the
/// local model may be several times too stiff. With 20 ms a falcon buzzes after a stall.
constexpr double kFall = 0.005;

/// Return of the whole force when nothing is owed any more [s]. Among 0, 10, 20, 30 ms the one at which
/// nothing buzzes in test/stability; from 0.1 s on slow swings take the buzz's place.
constexpr double kRecovery = 0.02;

/// A device that stays within this distance is at rest [m]: above the quantum of position of the devices in
/// test/stability, below the swings that are felt as a buzz there.
constexpr double kRestRadius = 1e-4;

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
  by_hand_ = by_loop_ = std::numeric_limits<double>::max();  // until observe() bounds them
  cloth_ = 0.0;
  gain_ = 1.0;
  velocity_ = Vec6::Zero();
  rested_ = fading_ = 0.0;
  wait_ = kFirstWait;
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
  const double debt = std::max(0.0, -energy());
  const double wanted = options_.debt > 0.0 ? options_.debt / (options_.debt + debt) : 1.0;
  gain_ = std::min(wanted, gain_ + period_ / kRecovery);
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

/// Nothing pays a debt where hand and cloth rest, so it fades there. What the loop creates meanwhile, as a
/// buzz that the returning force has woken, does not fade at once: whenever the debt has grown, it waits
/// four times as long as before.
void PassivityController::fadeAtRest(const Vec6& place) {
  rested_ += period_;
  if ((place - resting_place_).norm() > kRestRadius) {
    resting_place_ = place;
    rested_ = 0.0;
  }
  const double debt = -energy();
  if (rested_ < wait_ || debt <= 0.0) return;
  if (debt > fading_ + kGrowth * (options_.debt + debt)) {
    fading_ = debt;
    wait_ = std::min(kLongestWait, kLongerWait * wait_);
    rested_ = 0.0;
    return;
  }
  fade();
  fading_ -= debt + energy();
}

void PassivityController::fade() {
  for (double* energy : {&by_hand_, &by_loop_}) {
    if (*energy < 0.0) *energy *= std::exp(-period_ / kForgetting);
  }
}

void PassivityController::sent(const Vec6& force) { forces_.add(force); }

}  // namespace haptic_cloth
