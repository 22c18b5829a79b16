/// Between what a driver says and what the cloth feels: units, axes, scales. Pure functions.
#pragma once

#include <string>
#include <vector>

#include "haptic_cloth/haptics.h"
#include "ros/options/parameter_group.h"

namespace haptic_cloth {

/// What a device gives and takes: its pose and a force, or a measured force and where to go.
enum class DeviceKind { Impedance, Admittance };

/// How a device stands to the cloth. A position p of the driver lies at
///   offset + position_scale · orientation · (position_unit · p)
/// in the frame of the pose, which tf then brings into the cloth's.
struct DeviceOptions {
  DeviceKind kind = DeviceKind::Impedance;
  double position_unit = 1.0;           ///< what one unit of the driver's positions is [m]
  double position_scale = 1.0;          ///< way in the cloth's frame per way of the device [-]
  double force_scale = 1.0;             ///< force on the hand per force on the probe [-]
  Vec3 offset = Vec3::Zero();           ///< of the driver's origin, after scale and rotation [m]
  Quat orientation = Quat::Identity();  ///< of the driver's axes
  Quat force_axes = Quat::Identity();  ///< in which the driver takes forces, seen from those of its positions
  bool use_tf = true;             ///< whether tf brings the pose's frame into the cloth's; else they are one
  double max_stiffness = 0.0;     ///< that the device renders [N/m]; 0: not known
  double max_damping = 0.0;       ///< that the device renders [N·s/m]; 0: not known
  double workspace_radius = 0.0;  ///< [m]; 0: not known
};

/// @param device what holds where the group says nothing
/// @throws InputError for unknown keys and impossible values
DeviceOptions readDeviceOptions(ParameterGroup group, DeviceOptions device = DeviceOptions());

/// A position as the driver gives it, in the frame of its pose [m].
Vec3 placed(const DeviceOptions& device, const Vec3& position);

/// An orientation as the driver gives it, in the frame of its pose.
Quat placed(const DeviceOptions& device, const Quat& orientation);

/// What a driver must give for a device that is to stand there in the frame of its pose: undoes placed().
Vec3 positionForDriver(const DeviceOptions& device, const Vec3& position);
Quat orientationForDriver(const DeviceOptions& device, const Quat& orientation);

/// Force on the probe [N] as what the driver must apply to the hand: scaled, in the axes in which it takes
/// forces. With f the force on the probe and v its velocity, the hand receives force_scale/position_scale ·
/// (f·v): a constant factor, so scales cannot make energy where the cloth does not.
/// @param frame rotation of the pose's frame in the cloth's, from tf
Vec3 forceForDriver(const DeviceOptions& device, const Quat& frame, const Vec3& force);

/// The same for force and torque. Torque scales with force_scale/position_scale: the lever arm at the
/// device is that at the probe over position_scale. Orientations are not scaled, so the power of
/// turning changes by the same factor as that of moving.
Wrench wrenchForDriver(const DeviceOptions& device, const Quat& frame, const Wrench& wrench);

/// What a driver has measured of the hand's force on the device, as force on the probe [N]: undoes
/// forceForDriver().
Vec3 forceAtProbe(const DeviceOptions& device, const Quat& frame, const Vec3& force);

/// The limits of force and torque, and the tool of an admittance device, which hold at the device,
/// for a loop that computes in the cloth's forces and places.
HapticOptions limitsAtProbe(HapticOptions haptics, const DeviceOptions& device);

/// Stiffness that the hand feels of the coupling: K · position_scale · force_scale [N/m].
double feltStiffness(const DeviceOptions& device, const HapticOptions& haptics);

/// Damping that the hand feels of the coupling: B · position_scale · force_scale [N·s/m].
double feltDamping(const DeviceOptions& device, const HapticOptions& haptics);

/// What the device cannot render, in words that name the remedy; empty if all is well.
std::vector<std::string> deviceWarnings(const DeviceOptions& device, const HapticOptions& haptics);

}  // namespace haptic_cloth
