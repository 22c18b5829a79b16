#include "haptics/gain_ramp.h"

#include <algorithm>

namespace haptic_cloth {

GainRamp GainRamp::onTo(const Gains& gains, double now, double time) const {
  GainRamp ramp;
  ramp.from_ = at(now);
  ramp.to_ = gains;
  ramp.start_ = now;
  ramp.time_ = time;
  return ramp;
}

Gains GainRamp::at(double now) const {
  if (isDone(now)) return to_;
  const double share = std::max(0.0, (now - start_) / time_);
  const auto between = [share](double from, double to) { return from + share * (to - from); };
  return {between(from_.coupling_stiffness, to_.coupling_stiffness),
          between(from_.coupling_damping, to_.coupling_damping), between(from_.force_scale, to_.force_scale)};
}

}  // namespace haptic_cloth
