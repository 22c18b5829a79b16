/// Input of one simulation: cloth, world, probes and options. Format: docs/reference/scenes.md.
#pragma once

#include <array>
#include <string>
#include <vector>

#include "haptic_cloth/fabric.h"
#include "haptic_cloth/options.h"
#include "haptic_cloth/types.h"

namespace haptic_cloth {

/// Particles i0 … i1 × j0 … j1 of the finest grid, ends included, which are held. They keep their
/// place in the flat cloth at the start, or move from there as a rigid body: turn about an axis through
/// `centre`, which moves with `velocity`.
struct Pin {
  int i0 = 0, i1 = 0, j0 = 0, j1 = 0;
  Vec3 velocity = Vec3::Zero();  ///< [m/s]
  Vec3 turn = Vec3::Zero();      ///< angular velocity [rad/s]
  Vec3 centre = Vec3::Zero();    ///< point of the axis at time 0 [m]

  bool moves() const { return !velocity.isZero(0.0) || !turn.isZero(0.0); }
};

/// The sheet: a flat rectangle at the start.
struct ClothOptions {
  std::array<int, 2> particles{77, 77};               ///< finest grid along warp (x) and weft (y)
  std::array<double, 2> size{0.30, 0.30};             ///< [m]
  Pose pose{Vec3(0.0, 0.0, 0.10), Quat::Identity()};  ///< centre of the flat cloth
  Fabric fabric;
  std::vector<Pin> pins;       ///< a particle of several pins belongs to the first
  bool self_contact = true;    ///< layers of the cloth do not pass through each other
  double self_friction = 0.3;  ///< Coulomb coefficient of cloth on cloth [-]
};

/// Form of an obstacle.
enum class Shape { Box, Sphere, Cylinder, Capsule, Plane };

/// Position at a time, in the world frame.
struct PathPoint {
  double time = 0.0;             ///< [s]
  Vec3 position = Vec3::Zero();  ///< [m]
};

/// A solid with friction. The axis of a cylinder or capsule is local z; the normal of a plane is
/// local +z.
struct Obstacle {
  std::string name;  ///< name by which the node moves it; empty: it does not
  Shape shape = Shape::Plane;
  Vec3 size = Vec3::Zero();  ///< box: full side lengths [m]
  double radius = 0.0;       ///< sphere, cylinder, capsule [m]
  double length = 0.0;       ///< cylinder: full height; capsule: distance of its centres [m]
  Pose pose;
  double friction = 0.3;        ///< Coulomb coefficient [-]
  std::vector<PathPoint> path;  ///< positions over time, as for a probe; empty: no scripted motion
};

/// A sphere, or a capsule whose axis is local z.
struct ProbeOptions {
  std::string name = "probe";
  double radius = 0.008;              ///< [m]
  double length = 0.0;                ///< capsule: distance of its centres [m]; 0: sphere
  double friction = 0.2;              ///< [-]
  double coupling_stiffness = 400.0;  ///< stiffness of the virtual coupling [N/m]
  double coupling_damping = 1.0;      ///< damping of the virtual coupling [N·s/m]
  /// Scripted motion of the device, linear between rows and constant after the last; empty: none.
  std::vector<PathPoint> path;
  Quat orientation = Quat::Identity();  ///< orientation of a capsule on its path
  /// Intervals [from, to] in which the probe is closed on its path [s].
  std::vector<std::array<double, 2>> grasp;

  /// Largest distance of its surface from its origin [m].
  double extent() const { return radius + 0.5 * length; }

  /// Tells whether the coupling turns it. An open sphere is the same from all sides.
  bool isTurned(bool closed) const { return closed || length > 0.0; }
};

/// Conditions that end a run of `simulate`.
struct StopOptions {
  double time = 2.0;  ///< [s]
  /// The run ends earlier once the fastest particle stays below this speed [m/s]; 0: never.
  double rest_speed = 0.0;
};

/// A cloth in its world, and how it is simulated.
struct Scene {
  ClothOptions cloth;
  Vec3 gravity{0.0, 0.0, -9.81};  ///< [m/s²]
  double air_damping = 0.5;       ///< [1/s]
  std::vector<Obstacle> obstacles;
  std::vector<ProbeOptions> probes{ProbeOptions()};
  SolverOptions solver;
  AdaptOptions adapt;
  StopOptions stop;
};

/// Reads a scene file. `overrides` are "a.b=VALUE" with VALUE in YAML, applied in order.
/// @param overridden_by name of their source in messages
/// @throws InputError naming file, key, value and rule.
Scene loadScene(const std::string& file, const std::vector<std::string>& overrides = {},
                const std::string& overridden_by = "--set");

/// Reads a scene from YAML text.
/// @param origin name of the source in messages ("~ (parameters)")
/// @param base_directory directory that relative fabric paths start from
Scene parseScene(const std::string& yaml, const std::string& origin, const std::string& base_directory,
                 const std::vector<std::string>& overrides = {});

/// Checks the rules for a scene that was built in code; the loaders call it too.
/// @throws InputError with `origin` as file.
void validateScene(const Scene& scene, const std::string& origin);

/// Position on a path at a time [s]: linear between rows, the first row before, the last after.
Vec3 pathPosition(const std::vector<PathPoint>& path, double time);

}  // namespace haptic_cloth
