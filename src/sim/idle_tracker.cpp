#include "sim/idle_tracker.h"

#include <algorithm>
#include <climits>
#include <cmath>

#include "sim/sleep_tracker.h"

namespace haptic_cloth {

bool IdleTracker::isIdle(const Probes& probes, const ContactSet& contacts) const {
  if (!idle_ || contacts.obstaclesMove() || !devicesStay(probes)) return false;
  for (int k = 0; k < probes.count(); ++k) {
    const bool moves = probes.turnsAsPrescribed(k) || !probes.steps()[k].device_velocity.isZero(0.0);
    if (probes.isPresent(k) && (probes.isClosed(k) || moves)) return false;
  }
  return true;
}

void IdleTracker::note(const StepReport& report, const Probes& probes, double sleep_speed, int adapts) {
  const auto& reports = probes.reports();
  const bool proxies_rest = std::all_of(reports.begin(), reports.end(),
                                        [&](const ProbeReport& probe) {
                                          return !probe.present || probe.velocity.norm() < sleep_speed;
                                        }) &&
                            probes.fastestTurn() < sleep_speed;
  const bool changed = !devicesStay(probes) || report.refined > 0 || report.coarsened > 0 || report.failed;
  const int enough = std::max(SleepTracker::kSteps, adapts);
  quiet_ = report.awake_particles == 0 && proxies_rest && !changed ? std::min(quiet_, enough - 1) + 1 : 0;
  idle_ = quiet_ >= enough;
  probes_ = probes.steps();
  // That of a failed step may not be finite.
  if (!report.failed) skipped_.minimizer.residual = report.minimizer.residual;
  skipped_.self_contacts = report.self_contacts;
  skipped_.min_self_gap = report.min_self_gap;
  skipped_.max_penetration = report.max_penetration;
}

void IdleTracker::forget() {
  quiet_ = 0;
  idle_ = false;
}

/// Tells whether the same probes are present as in the last solved step, with their devices in the
/// same positions.
bool IdleTracker::devicesStay(const Probes& probes) const {
  return std::equal(probes.steps().begin(), probes.steps().end(), probes_.begin(), probes_.end(),
                    [](const ProbeStep& now, const ProbeStep& then) {
                      return now.present == then.present && now.device == then.device &&
                             now.device_orientation.coeffs() == then.device_orientation.coeffs();
                    });
}

void IdleTracker::serialize(Archive& archive) {
  archive.within("idle.quiet", quiet_, 0, INT_MAX / 2);
  archive("idle.idle", idle_);
  archive.length("idle.count", probes_, count_);
  archive.each("idle.present", probes_, &ProbeStep::present);
  archive.each("idle.devices", probes_, &ProbeStep::device);
  archive.each("idle.orientations", probes_, &ProbeStep::device_orientation);
  archive("idle.residual", skipped_.minimizer.residual);
  archive.within("idle.self_contacts", skipped_.self_contacts, 0, INT_MAX);
  archive("idle.max_penetration", skipped_.max_penetration);
  constexpr double kNone = -1.0;  // entries are finite
  double gap = std::isfinite(skipped_.min_self_gap) ? skipped_.min_self_gap : kNone;
  archive("idle.min_self_gap", gap);
  skipped_.min_self_gap = gap < 0.0 ? StepReport().min_self_gap : gap;
}

}  // namespace haptic_cloth
