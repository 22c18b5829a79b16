/// Phase lock of the ticks to a device. Criteria: from any phase, a message is answered within 0.3
/// ms after at most 60 ticks (half a period in shifts of at most 2 %, then a tenth of the rest per
/// tick); no tick is shifted by more than 2 %; a silent device changes nothing.
#include "haptics/tick_phase.h"

#include <gtest/gtest.h>

#include <cmath>

namespace haptic_cloth::tick_phase_test {
namespace {

constexpr double kPeriod = 1e-3;

/// Time of the newest message at `now`, if messages come at `first` + k `spacing`.
double heardAt(double now, double first, double spacing) {
  return now < first ? -1.0 : first + std::floor((now - first) / spacing) * spacing;
}

TEST(TickPhase, TicksFallIntoStepWithTheDevice) {
  for (const double spacing : {1e-3, 2e-3, 1.0005e-3}) {
    for (double phase = 0.0; phase < 1.0; phase += 0.05) {
      double now = 10.0, longest = 0.0;
      for (int k = 0; k < 1000; ++k) {
        const double heard = heardAt(now, 9.5 + phase * kPeriod, spacing);
        const double due = inPhase(now + kPeriod, heard, kPeriod);
        EXPECT_NEAR(due - now, kPeriod, 0.02 * kPeriod * (1.0 + 1e-6));
        if (k > 60) longest = std::max(longest, std::fmod(now - heard, kPeriod));
        now = due;
      }
      EXPECT_LT(longest, 3e-4) << "spacing " << spacing << " phase " << phase;
    }
  }
}

TEST(TickPhase, ASilentDeviceChangesNothing) {
  EXPECT_EQ(inPhase(10.0, -1.0, kPeriod), 10.0);
  EXPECT_EQ(inPhase(10.0, 9.9, kPeriod), 10.0);
}

}  // namespace
}  // namespace haptic_cloth::tick_phase_test
