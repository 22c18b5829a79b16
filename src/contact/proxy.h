/// Where the proxy of a probe is in a step, and how it turns.
#pragma once

#include <vector>

#include "haptic_cloth/types.h"

namespace haptic_cloth {

/// Place of a proxy, or how fast it changes along a direction. A turn is a rotation vector: its axis times
/// its angle.
struct Proxy {
  Vec3 position = Vec3::Zero();  ///< [m]
  Vec3 turn = Vec3::Zero();      ///< since the step began; of a direction: angular [rad]
};

using Proxies = std::vector<Proxy>;  ///< one for each probe of the scene

/// Rotation by a rotation vector [rad].
Quat rotationBy(const Vec3& turn);

/// Rotation vector of the shorter way from one orientation to another [rad].
Vec3 turnBetween(const Quat& from, const Quat& to);

/// Angular displacement per change of the rotation vector at `turn` [rad]: the left Jacobian of rotations.
Mat3 spinPerTurn(const Vec3& turn);

}  // namespace haptic_cloth
