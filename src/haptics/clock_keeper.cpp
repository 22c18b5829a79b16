#include "haptics/clock_keeper.h"

#include <algorithm>
#include <cmath>

namespace haptic_cloth {
namespace {

/// Time in which the lag must fall by a time step, or the rung is too slow [s].
constexpr double kPatience = 0.03;
/// Share of wall time that is lost at a rung that is far too slow. On a drape one rung makes steps 1.1 to 1.9
/// times as fast and two make them 1.5 to 3.1 times as fast (quality_ladder.cpp), so one alone would not do.
constexpr double kMuch = 0.5;
/// Load below which a better rung is tried: one costs up to 1.9 times the next (quality_ladder.cpp), and a
/// twentieth is left for what varies.
constexpr double kRoom = 0.5;
/// The time that a step takes grows with this power of its length. Measured: from 0.3 to 0.7, up to 0.95 on
/// coarse meshes (docs/decisions/0028-the-node-keeps-the-clock.md).
constexpr double kGrowth = 2.0 / 3.0;
constexpr double kSmoothing = 0.1;                    ///< simulated time over which the load is a mean [s]
constexpr double kFirstWait = 0.5, kLastWait = 30.0;  ///< [s]
constexpr double kSoon = 2.0;                         ///< a rung that was left sooner has failed [s]

}  // namespace

void ClockKeeper::setRungs(const std::vector<int>& longest_steps, int gentle) {
  longest_ = longest_steps;
  gentle_ = gentle;
  waits_.assign(longest_.size(), kFirstWait);
  rung_ = std::min(rung_, static_cast<int>(longest_.size()) - 1);
  behind_ = roomy_ = risen_ = false;
}

ClockKeeper::Step ClockKeeper::begin(double now) {
  if (!std::isfinite(now)) now = begun_;
  if (isDue(now)) due_ = now;
  const double given_up = std::max(0.0, now - due_ - kLongestLag);
  slipped_ += given_up;
  due_ += given_up;
  const double lag = now - due_;
  chooseRung(lag, now);
  const double steps = 1.0 + std::floor(std::max(0.0, lag) / h_);
  const int wanted = static_cast<int>(std::min<double>(steps, longest_[rung_]));
  length_ = std::clamp(wanted, (length_ + 1) / 2, 2 * length_);
  due_ += length_ * h_;
  begun_ = now;
  return {length_, rung_};
}

void ClockKeeper::end(double now, bool cut) {
  if (!std::isfinite(now)) now = begun_;
  cut_ = cut;
  const double load = (now - begun_) / (h_ * std::pow(length_, kGrowth));
  load_ += std::min(1.0, length_ * h_ / kSmoothing) * (load - load_);
}

void ClockKeeper::restart() {
  due_ = -1.0;
  behind_ = roomy_ = false;
}

void ClockKeeper::chooseRung(double lag, double now) {
  const bool was_behind = behind_, had_room = roomy_;
  behind_ = lag > std::min(longest_[rung_] * h_, 0.5 * kLongestLag);
  // The better rung grants more iterations, in steps that may be as long.
  const bool limits = rung_ >= gentle_ && longest_[rung_] <= longest_[rung_ - 1];
  roomy_ = rung_ > 0 && !behind_ &&
           ((limits && !cut_) || load_ * std::pow(longest_[rung_ - 1], kGrowth - 1.0) < kRoom);
  if (behind_ && (!was_behind || now - behind_since_ >= kPatience)) {
    const double grown = slipped_ + lag - behind_by_;
    const bool far_too_slow = grown > kMuch * (now - behind_since_) && behind_steps_ > 1 && !risen_;
    const int rungs = !was_behind || grown <= -h_ ? 0 : far_too_slow && rung_ + 2 < gentle_ ? 2 : 1;
    behind_since_ = now;
    behind_by_ = slipped_ + lag;
    behind_steps_ = 0;
    for (int k = 0; k < rungs && rung_ + 1 < static_cast<int>(longest_.size()); ++k) fall(now);
  }
  ++behind_steps_;
  if (roomy_ && !had_room) roomy_since_ = now;
  if (roomy_ && now - roomy_since_ >= waits_[rung_ - 1]) rise(now);
}

void ClockKeeper::fall(double now) {
  if (risen_) {
    double& wait = waits_[rung_];
    const bool failed = now - risen_at_ < std::max(kSoon, wait);
    wait = failed ? std::min(2.0 * wait, kLastWait) : kFirstWait;
  }
  ++rung_;
  behind_ = risen_ = false;
}

void ClockKeeper::rise(double now) {
  if (risen_) waits_[rung_] = kFirstWait;  // the rise before this one has held
  --rung_;
  roomy_ = false;
  risen_ = true;
  risen_at_ = now;
}

}  // namespace haptic_cloth
