#include "contact/solid_set.h"

#include <algorithm>
#include <string>

namespace haptic_cloth {

SolidSet::SolidSet(const std::vector<Obstacle>& obstacles, const std::vector<ProbeOptions>& probes,
                   double edge_radius)
    : obstacles_(static_cast<int>(obstacles.size())),
      paths_(obstacles.size(), 0.0),
      turns_(probes.size(), Mat3::Identity()),
      ways_(probes.size(), Vec3::Zero()) {
  for (const Obstacle& obstacle : obstacles) {
    solids_.emplace_back(obstacle, edge_radius);
    targets_.push_back(obstacle.pose);
  }
  for (const ProbeOptions& probe : probes) solids_.emplace_back(probe);
  before_ = solids_;
}

bool SolidSet::isStill(int solid) const {
  const Solid &now = solids_[solid], &then = before_[solid];
  return now.position() == then.position() && now.rotation() == then.rotation();
}

/// Limits the motion of obstacles: none may pass through the cloth within a step. An obstacle that
/// is sent farther lags behind.
void SolidSet::advance(const Field& cloth) {
  constexpr double kShareOfWidth = 0.25;
  constexpr double kLargestSpin = 0.25;  ///< about an axis of symmetry: friction follows chords [rad]
  for (int k = 0; k < obstacles_; ++k) {
    Solid& solid = solids_[k];
    before_[k] = solid;
    const Pose& target = targets_[k];
    const Quat turned(solid.rotation());
    const Vec3 turn = turnBetween(turned, target.orientation), swing = solid.swing(turn);
    const double distance = (target.position - solid.position()).norm() + solid.extent() * swing.norm();
    const double share =
        std::min({1.0, kShareOfWidth * solid.halfWidth() / distance, kLargestSpin / (turn - swing).norm()});
    if (share < 1.0) {
      solid.place(solid.position() + share * (target.position - solid.position()));
      solid.turn(turned.slerp(share, target.orientation));
    } else {
      solid.place(target.position);
      solid.turn(target.orientation);
    }
    paths_[k] = pathOf(k, cloth);
  }
}

bool SolidSet::obstaclesMove() const {
  for (int k = 0; k < obstacles_; ++k) {
    const Mat3 target = targets_[k].orientation.toRotationMatrix();
    const auto moves = [&](const Solid& solid) {
      return solid.position() != targets_[k].position || solid.rotation() != target;
    };
    if (moves(solids_[k]) || moves(before_[k])) return true;
  }
  return false;
}

double SolidSet::pathOf(int obstacle, const Field& cloth) const {
  if (isStill(obstacle)) return 0.0;
  const Solid &now = solids_[obstacle], &then = before_[obstacle];
  double extent = now.extent();
  if (extent == 0.0) {  // a plane
    for (int n = 0; n < cloth.size(); ++n) extent = std::max(extent, (cloth[n] - now.position()).norm());
  }
  const double turned = Quat(now.rotation()).angularDistance(Quat(then.rotation()));
  return (now.position() - then.position()).norm() + extent * turned;
}

void SolidSet::startProbe(int probe, const Vec3& proxy, const Quat& before, const Quat& after,
                          const Vec3& way) {
  Solid &now = solids_[indexOf(probe)], &then = before_[indexOf(probe)];
  for (Solid* solid : {&now, &then}) solid->place(proxy);
  now.turn(after);
  then.turn(before);
  turns_[probe].setIdentity();
  ways_[probe] = way;
}

void SolidSet::serialize(Archive& archive) {
  for (int k = 0; k < obstacles_; ++k) {
    archive("now[" + std::to_string(k) + "]", solids_[k]);
    archive("before[" + std::to_string(k) + "]", before_[k]);
  }
  archive.each("target_positions", targets_, &Pose::position);
  archive.each("target_orientations", targets_, &Pose::orientation);
}

}  // namespace haptic_cloth
