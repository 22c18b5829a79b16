#include "haptics/probe_tracker.h"

#include <Eigen/Eigenvalues>
#include <algorithm>
#include <cmath>

#include "contact/proxy.h"

namespace haptic_cloth {
namespace {

/// A move of the device of this length says as much as what was known before [m]: about a device's quantum.
constexpr double kTrustedMove = 1e-5;

/// Low pass of the drift [s]: a jump of one step, where cloth slips or the mesh changes, is no speed.
constexpr double kDriftTime = 0.001;

/// Time in which an error of the force fades to 1/e [s]: what one solve leaves undone the next ones feel,
/// too.
constexpr double kErrorTime = 0.02;

}  // namespace

ProbeSnapshot ProbeTracker::update(const ProbeReport& probe, const DeviceSample& device, double step_interval,
                                   double taken) {
  ProbeSnapshot snapshot;
  snapshot.taken = taken;
  snapshot.device_received = device.received;
  snapshot.device = probe.device;
  snapshot.device_orientation = device.orientation;
  snapshot.proxy = probe.proxy;
  snapshot.proxy_orientation = probe.orientation;
  snapshot.turn_radius = probe.turn_radius;
  snapshot.force = probe.force;
  snapshot.torque = probe.torque;
  snapshot.contact = probe.present && probe.contact;
  snapshot.holds = probe.grasps;
  snapshot.inside = probe.inside;
  snapshot.way_out = probe.way_out;
  snapshot.trust = trustIn(probe, step_interval);
  if (!snapshot.contact || !known_) {
    follow_.setIdentity();
    drift_.setZero();
  } else {
    // Only positions are known of a coupling that did not turn the probe in the step before, or does not in
    // this one.
    if (last_.turn_radius != probe.turn_radius) forgetTurns();
    const double radius = std::min(last_.turn_radius, probe.turn_radius);
    const Vec6 device_moved = joined(probe.device - last_.device,
                                     radius * turnBetween(last_.device_orientation, device.orientation));
    const Vec6 proxy_moved =
        joined(probe.proxy - last_.proxy, radius * turnBetween(last_.proxy_orientation, probe.orientation));
    if (last_.contact) learn(device_moved, proxy_moved);
    // From moves of the same step, so that what the hand did cancels in what the proxy did beside it.
    const Vec6 drift = (proxy_moved - follow_ * device_moved) / step_interval;
    drift_ -= std::expm1(-step_interval / kDriftTime) * (drift - drift_);
  }
  snapshot.follow = follow_;
  snapshot.drift = drift_;
  known_ = probe.present;
  last_ = snapshot;
  return snapshot;
}

/// Share of the force that may be passed on: 1 where it exceeds its estimated error, now and lately;
/// otherwise the square of their ratio.
double ProbeTracker::trustIn(const ProbeReport& probe, double step_interval) {
  error_ = std::max(probe.force_error, std::exp(-step_interval / kErrorTime) * error_);
  const double force = probe.force.norm(), ratio = error_ > force ? force / error_ : 1.0;
  return ratio * ratio;
}

void ProbeTracker::forgetTurns() {
  const Mat3 kept = follow_.topLeftCorner<3, 3>();
  follow_.setIdentity();
  follow_.topLeftCorner<3, 3>() = kept;
  drift_.tail<3>().setZero();
}

void ProbeTracker::learn(const Vec6& device_moved, const Vec6& proxy_moved) {
  const Vec6 wrong = proxy_moved - follow_ * device_moved;
  const double length = device_moved.squaredNorm();
  const Vec6 direction = device_moved / (length + kTrustedMove * kTrustedMove);
  const Mat6 change = wrong * direction.transpose();
  const Mat6 secant =
      follow_ + change + change.transpose() - wrong.dot(direction) * device_moved * direction.transpose();
  if (!secant.allFinite()) return;
  const Eigen::SelfAdjointEigenSolver<Eigen::Matrix<double, 6, 6>> solver(secant);
  const Vec6 bounded = solver.eigenvalues().cwiseMax(0.0).cwiseMin(1.0);
  follow_ = solver.eigenvectors() * bounded.asDiagonal() * solver.eigenvectors().transpose();
}

}  // namespace haptic_cloth
