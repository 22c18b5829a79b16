/// Maps between a driver's values and those of the cloth: units, axes, scales. Pure functions.
#pragma once

#include <string>
#include <vector>

#include "haptic_cloth/haptics.h"
#include "ros/options/parameter_group.h"

namespace haptic_cloth {

/// Direction of the data: pose in and force out (impedance), or force in and target pose out
/// (admittance).
enum class DeviceKind { Impedance, Admittance };

/// How a device maps to the cloth. A position p of the driver is mapped to
/// offset + position_scale · orientation · (position_unit · p)
/// in the frame of the pose, which tf then transforms into the cloth's frame.
struct DeviceOptions {
  DeviceKind kind = DeviceKind::Impedance;
  double position_unit = 1.0;           ///< length of one unit of the driver's positions [m]
  double position_scale = 1.0;          ///< motion of the probe per motion of the device [-]
  double force_scale = 1.0;             ///< force on the hand per force on the probe [-]
  Vec3 offset = Vec3::Zero();           ///< driver's origin, after scale and rotation [m]
  Quat orientation = Quat::Identity();  ///< orientation of the driver's axes
  /// Axes in which the driver takes forces, relative to those of its positions.
  Quat force_axes = Quat::Identity();
  /// Whether tf transforms the pose's frame; otherwise it is the cloth's frame.
  bool use_tf = true;
  double max_stiffness = 0.0;     ///< largest stiffness that the device renders [N/m]; 0: unknown
  double max_damping = 0.0;       ///< largest damping that the device renders [N·s/m]; 0: unknown
  double workspace_radius = 0.0;  ///< [m]; 0: unknown
};

inline Names<DeviceKind> deviceKindNames() {
  return {{"impedance", DeviceKind::Impedance}, {"admittance", DeviceKind::Admittance}};
}

Options optionsOf(DeviceOptions& device);

/// @param device defaults for keys that the group does not have
/// @throws InputError for an unknown key or an invalid value
DeviceOptions readDeviceOptions(ParameterGroup group, DeviceOptions device = DeviceOptions());

/// Maps a driver's position into the frame of its pose [m].
Vec3 placed(const DeviceOptions& device, const Vec3& position);

/// Maps a driver's orientation into the frame of its pose.
Quat placed(const DeviceOptions& device, const Quat& orientation);

/// Inverse of placed(): what a driver must send for a device at this place in the frame of its
/// pose.
Pose poseForDriver(const DeviceOptions& device, const Pose& pose);

/// Maps the force on the probe [N] to the force that the driver must apply to the hand: scaled, in
/// the axes in which the driver takes forces. With f the force on the probe and v its velocity, the
/// hand receives the power force_scale/position_scale · (f·v). The factor is constant, so the
/// scales cannot create energy.
/// @param frame rotation of the pose's frame in the cloth's frame, from tf
Vec3 forceForDriver(const DeviceOptions& device, const Quat& frame, const Vec3& force);

/// Maps force and torque. Torque scales with force_scale/position_scale, because a lever arm at the
/// device is the one at the probe divided by position_scale. Orientations are not scaled, so the
/// power of rotation changes by the same factor as that of translation.
Wrench wrenchForDriver(const DeviceOptions& device, const Quat& frame, const Wrench& wrench);

/// Wrench on the hand for a wrench on the probe, in the axes of the latter.
Wrench wrenchOnHand(const DeviceOptions& device, const Wrench& wrench);

/// Inverse of forceForDriver(): maps the measured force of the hand on the device to a force on the
/// probe [N].
Vec3 forceAtProbe(const DeviceOptions& device, const Quat& frame, const Vec3& force);

/// Converts limits of force and torque, passivity and the admittance tool from the device, where they
/// are defined, to the forces and lengths of the cloth, in which the loop computes.
HapticOptions limitsAtProbe(HapticOptions haptics, const DeviceOptions& device);

/// Stiffness of the coupling as the hand feels it: K · position_scale · force_scale [N/m].
double feltStiffness(const DeviceOptions& device, const HapticOptions& haptics);

/// Damping of the coupling as the hand feels it: B · position_scale · force_scale [N·s/m].
double feltDamping(const DeviceOptions& device, const HapticOptions& haptics);

/// Warnings about what the device cannot render, each with a remedy; empty if there are none. An
/// admittance device renders no force.
std::vector<std::string> deviceWarnings(const DeviceOptions& device, const HapticOptions& haptics);

}  // namespace haptic_cloth
