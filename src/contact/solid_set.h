/// Solids of a scene, and how they move from step to step.
#pragma once

#include <vector>

#include "contact/proxy.h"
#include "contact/solid.h"
#include "mesh/field.h"

namespace haptic_cloth {

/// Rotation by a share of the angle.
inline Eigen::AngleAxisd partOf(const Eigen::AngleAxisd& turn, double share) {
  return {share * turn.angle(), turn.axis()};
}

/// Obstacles first, then probes, each at the start and at the end of the current step.
class SolidSet {
 public:
  /// @param edge_radius of the obstacles, see Solid [m]
  SolidSet(const std::vector<Obstacle>& obstacles, const std::vector<ProbeOptions>& probes,
           double edge_radius);

  int size() const { return static_cast<int>(solids_.size()); }
  int obstacles() const { return obstacles_; }
  int indexOf(int probe) const { return obstacles_ + probe; }
  bool isProbe(int solid) const { return solid >= obstacles_; }

  /// A solid at the end and at the start of the step.
  const Solid& operator[](int solid) const { return solids_[solid]; }
  const Solid& before(int solid) const { return before_[solid]; }

  /// Tells whether a solid neither moves nor turns in the step.
  bool isStill(int solid) const;

  /// Rotation of a solid in the step.
  Eigen::AngleAxisd turnInStep(int solid) const {
    return Eigen::AngleAxisd(solids_[solid].rotation() * before_[solid].rotation().transpose());
  }

  /// Origin of the samples' positions: the proxy of a probe, for an obstacle that of the world [m].
  Vec3 origin(int solid) const { return isProbe(solid) ? solids_[solid].position() : Vec3::Zero(); }

  /// Part of a direction that moves a solid. @param d_proxies directions of all probes
  Proxy motion(int solid, const Proxies& d_proxies) const {
    return isProbe(solid) ? d_proxies[solid - obstacles_] : Proxy();
  }

  /// Moves the obstacles one step towards their targets. @param cloth positions of its nodes [m]
  void advance(const Field& cloth);
  void moveObstacle(int obstacle, const Pose& pose) { targets_[obstacle] = pose; }
  /// Tells whether an obstacle has not arrived or just moved.
  bool obstaclesMove() const;
  /// Longest path of an obstacle's points in the step, of a plane as far as the cloth reaches [m].
  double pathLength(int obstacle) const { return paths_[obstacle]; }
  /// Way in the step of a point that is fixed to an obstacle and starts at x [m].
  Vec3 carried(int obstacle, const Vec3& x) const {
    const Solid &now = solids_[obstacle], &then = before_[obstacle];
    return now.position() + now.rotation() * (then.rotation().transpose() * (x - then.position())) - x;
  }

  /// Places a probe at the start of a step: its proxy [m], and its orientation at start and end. If the solve
  /// turns it, too, both are that of the start.
  /// @param way of the proxy in the step, expected [m]
  void startProbe(int probe, const Vec3& proxy, const Quat& before, const Quat& after, const Vec3& way);

  /// Way of a solid's origin in the step; of a probe the one expected [m].
  Vec3 way(int solid) const {
    return isProbe(solid) ? ways_[solid - obstacles_] : solids_[solid].position() - before_[solid].position();
  }

  /// Moves the proxy of a probe for the next evaluation [m].
  void placeProbe(int probe, const Vec3& proxy) { solids_[indexOf(probe)].place(proxy); }

  /// Turns a probe from its orientation at the start of the step for the next evaluation.
  void turnProbe(int probe, const Mat3& turn) {
    solids_[indexOf(probe)].turn(turn * before_[indexOf(probe)].rotation());
    turns_[probe] = turn;
  }

  /// Rotation by which the solve has turned a solid.
  Mat3 turned(int solid) const { return isProbe(solid) ? turns_[solid - obstacles_] : Mat3::Identity(); }

  /// Saves or loads poses and targets of the obstacles; probes are placed in each step.
  void serialize(Archive& archive);

 private:
  double pathOf(int obstacle, const Field& cloth) const;

  int obstacles_;              ///< number of obstacles; the other solids are probes
  std::vector<Solid> solids_;  ///< at the end of the current step
  std::vector<Solid> before_;  ///< at its start
  std::vector<Pose> targets_;  ///< poses of the obstacles
  std::vector<double> paths_;  ///< of the obstacles, see pathLength() [m]
  std::vector<Mat3> turns_;    ///< of the probes, see turned()
  std::vector<Vec3> ways_;     ///< of the probes, see way() [m]
};

}  // namespace haptic_cloth
