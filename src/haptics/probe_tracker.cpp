#include "haptics/probe_tracker.h"

#include <Eigen/Eigenvalues>
#include <cmath>

namespace haptic_cloth {
namespace {

/// A move of the device of this length says as much as what was known before [m]: about a device's quantum.
constexpr double kTrustedMove = 1e-5;

/// Low pass of the drift [s]: a jump of one step, where cloth slips or the mesh changes, is no speed.
constexpr double kDriftTime = 0.001;

}  // namespace

ProbeSnapshot ProbeTracker::update(const ProbeReport& probe, const DeviceSample& device, double step_interval,
                                   double taken) {
  ProbeSnapshot snapshot;
  snapshot.taken = taken;
  snapshot.device_received = device.received;
  snapshot.device = probe.device;
  snapshot.proxy = probe.proxy;
  snapshot.force = probe.force;
  snapshot.torque = probe.torque;
  snapshot.contact = probe.present && probe.contact;
  snapshot.holds = probe.grasps;
  if (!snapshot.contact || !known_) {
    follow_.setIdentity();
    drift_.setZero();
  } else {
    const Vec3 device_moved = probe.device - device_, proxy_moved = probe.proxy - proxy_;
    if (touched_) learn(device_moved, proxy_moved);
    // From moves of the same step, so that what the hand did cancels in what the proxy did beside it.
    const Vec3 drift = (proxy_moved - follow_ * device_moved) / step_interval;
    drift_ -= std::expm1(-step_interval / kDriftTime) * (drift - drift_);
  }
  snapshot.follow = follow_;
  snapshot.drift = drift_;
  known_ = probe.present;
  touched_ = snapshot.contact;
  device_ = probe.device;
  proxy_ = probe.proxy;
  return snapshot;
}

void ProbeTracker::learn(const Vec3& device_moved, const Vec3& proxy_moved) {
  const Vec3 wrong = proxy_moved - follow_ * device_moved;
  const double length = device_moved.squaredNorm();
  const Vec3 direction = device_moved / (length + kTrustedMove * kTrustedMove);
  const Mat3 change = wrong * direction.transpose();
  const Mat3 secant =
      follow_ + change + change.transpose() - wrong.dot(direction) * device_moved * direction.transpose();
  if (!secant.allFinite()) return;
  Eigen::SelfAdjointEigenSolver<Mat3> solver;
  solver.computeDirect(secant);
  const Vec3 bounded = solver.eigenvalues().cwiseMax(0.0).cwiseMin(1.0);
  follow_ = solver.eigenvectors() * bounded.asDiagonal() * solver.eigenvectors().transpose();
}

}  // namespace haptic_cloth
