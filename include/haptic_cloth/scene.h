/// Everything one simulation needs: cloth, world, probe and options. Format: docs/reference/scenes.md.
#pragma once

#include <array>
#include <optional>
#include <string>
#include <vector>

#include "haptic_cloth/fabric.h"
#include "haptic_cloth/options.h"
#include "haptic_cloth/types.h"

namespace haptic_cloth {

/// Particles i0..i1 x j0..j1 of the finest grid, ends included.
struct ParticleRange {
  int i0, i1, j0, j1;
};

/// The sheet: a flat rectangle at the start.
struct ClothOptions {
  std::array<int, 2> particles{77, 77};               ///< finest grid: along warp (x), weft (y)
  std::array<double, 2> size{0.30, 0.30};             ///< [m]
  Pose pose{Vec3(0.0, 0.0, 0.10), Quat::Identity()};  ///< centre of the flat cloth
  Fabric fabric;
  std::vector<ParticleRange> pins;  ///< held where they start
};

/// Form of an obstacle.
enum class Shape { Box, Sphere, Cylinder, Capsule, Plane };

/// Position at a time, in the world frame.
struct PathPoint {
  double time;    ///< [s]
  Vec3 position;  ///< [m]
};

/// A solid with friction. Cylinder and capsule have their axis along local z, a plane its normal along local
/// +z.
struct Obstacle {
  std::string name;  ///< by which it can be moved; empty: it stays
  Shape shape = Shape::Plane;
  Vec3 size = Vec3::Zero();  ///< box: full side lengths [m]
  double radius = 0.0;       ///< sphere, cylinder, capsule [m]
  double length = 0.0;       ///< cylinder: full height; capsule: distance of the two centres [m]
  Pose pose;
  double friction = 0.3;        ///< Coulomb coefficient [-]
  std::vector<PathPoint> path;  ///< of its position, as a probe's; empty: it stays until moved
};

/// A sphere, or a capsule with its axis along local z.
struct ProbeOptions {
  std::string name = "probe";
  double radius = 0.008;              ///< [m]
  double length = 0.0;                ///< of a capsule: distance of its two centres [m]; 0: a sphere
  double friction = 0.2;              ///< [-]
  double coupling_stiffness = 400.0;  ///< virtual coupling, device to proxy [N/m]
  double coupling_damping = 1.0;      ///< [N·s/m]
  std::vector<PathPoint> path;        ///< linear between rows, held after the last; empty: no scripted motion
  Quat orientation = Quat::Identity();       ///< of a capsule on its path
  std::vector<std::array<double, 2>> grasp;  ///< from, to: closed meanwhile on its path [s]
};

/// When a run of `simulate` ends.
struct StopOptions {
  double time = 2.0;        ///< [s]
  double rest_speed = 0.0;  ///< ends earlier when the fastest particle stays below [m/s]; 0: never
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

/// Reads a scene file; `overrides` are "a.b=VALUE" with VALUE in YAML, applied in order.
/// @throws InputError naming file, key, value and rule.
Scene loadScene(const std::string& file, const std::vector<std::string>& overrides = {});

/// Reads a scene from YAML text. @param origin names the source in messages ("~ (parameters)");
/// @param base_directory is where relative fabric paths start.
Scene parseScene(const std::string& yaml, const std::string& origin, const std::string& base_directory,
                 const std::vector<std::string>& overrides = {});

/// Checks what a scene built in code must fulfil; the loaders call it too.
/// @throws InputError with `origin` as file.
void validateScene(const Scene& scene, const std::string& origin);

/// Position on a path at a time [s]: linear between rows, the first before, the last after.
Vec3 pathPosition(const std::vector<PathPoint>& path, double time);

}  // namespace haptic_cloth
