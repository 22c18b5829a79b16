/// Units, axes and scales of devices, the warnings about them, and every shipped preset.
#include "ros/input/device_map.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <filesystem>
#include <map>
#include <random>
#include <set>

#include "haptic_cloth/error.h"
#include "ros/display/diagnostics.h"
#include "ros/input/unit_check.h"
#include "ros/options/node_options.h"
#include "ros/support/yaml_parameters.h"

namespace haptic_cloth::device_map_test {
namespace {

using XmlRpc::XmlRpcValue;
namespace fs = std::filesystem;

const fs::path kConfig = fs::path(HAPTIC_CLOTH_SOURCE_DIR) / "config";

class DeviceMapTest : public testing::Test {
 protected:
  double number(double low, double high) {
    return std::uniform_real_distribution<double>(low, high)(random_);
  }
  Vec3 vector() { return {number(-1, 1), number(-1, 1), number(-1, 1)}; }
  Quat rotation() { return Quat(number(-1, 1), number(-1, 1), number(-1, 1), number(-1, 1)).normalized(); }
  DeviceOptions device() {
    DeviceOptions device;
    device.position_unit = number(0.001, 1.0);
    device.position_scale = number(0.2, 5.0);
    device.force_scale = number(0.2, 5.0);
    device.offset = vector();
    device.orientation = rotation();
    device.force_axes = rotation();
    return device;
  }
  std::mt19937 random_{20};
};

/// Power on the hand = force_scale/position_scale · power on the probe, for all units, axes and
/// frames, as forceForDriver() states. Both sides are exact up to rounding; for positions of size 1
/// in double the tolerance is 1e-12.
TEST_F(DeviceMapTest, PowerOnTheHandIsThatOnTheProbeTimesAConstant) {
  for (int k = 0; k < 100; ++k) {
    const DeviceOptions options = device();
    const Quat frame = rotation();  // rotation of the pose's frame, from tf
    const Vec3 position = vector(), velocity = vector(), force = vector();
    // The map is affine, so a whole second of velocity is exact.
    const Vec3 probe_velocity = frame * (placed(options, position + velocity) - placed(options, position));
    const Vec3 hand_velocity = options.position_unit * velocity;
    const Vec3 hand_force = options.force_axes * forceForDriver(options, frame, force);
    EXPECT_NEAR(hand_force.dot(hand_velocity),
                options.force_scale / options.position_scale * force.dot(probe_velocity), 1e-12);
    // Rotation: the driver's orientations are those in the cloth's frame in other axes, not scaled.
    const Vec3 spin = vector(), torque = vector();
    const Vec3 probe_spin = frame * options.orientation * spin;
    const Vec3 hand_torque = options.force_axes * wrenchForDriver(options, frame, {force, torque}).torque;
    EXPECT_NEAR(hand_torque.dot(spin), options.force_scale / options.position_scale * torque.dot(probe_spin),
                1e-12);
    EXPECT_EQ(wrenchForDriver(options, frame, {force, torque}).force, forceForDriver(options, frame, force));
  }
}

/// The coupling f = K (proxy - device), differentiated along the hand's path: feltStiffness() is
/// compared with a difference quotient.
TEST_F(DeviceMapTest, TheFeltStiffnessIsThatOfTheCouplingTimesBothScales) {
  for (int k = 0; k < 100; ++k) {
    const DeviceOptions options = device();
    HapticOptions haptics;
    haptics.coupling_stiffness = number(100.0, 1000.0);
    // The step is 10 mm.
    const Vec3 direction = vector().normalized(), step = 0.01 / options.position_unit * direction;
    const auto feel = [&](const Vec3& position) {
      const Vec3 force = haptics.coupling_stiffness * (Vec3(0.1, 0.2, 0.3) - placed(options, position));
      return Vec3(options.force_axes * forceForDriver(options, Quat::Identity(), force));
    };
    const double stiffness = -(feel(step) - feel(Vec3::Zero())).dot(direction) / 0.01;
    EXPECT_NEAR(stiffness, feltStiffness(options, haptics), 1e-9 * stiffness);
  }
}

/// Half turns and quarter turns computed by hand, so that signs are correct and not only
/// consistent.
TEST(DeviceMap, AxesOfOpenHapticsAndForceDimensionStandUpright) {
  const double half = std::sqrt(0.5);
  DeviceOptions device;
  device.orientation = Quat(half, half, 0, 0);  // OpenHaptics
  EXPECT_TRUE(placed(device, Vec3(0, 1, 0)).isApprox(Vec3::UnitZ(), 1e-12)) << "up";
  EXPECT_TRUE(placed(device, Vec3(0, 0, 1)).isApprox(-Vec3::UnitY(), 1e-12)) << "towards the person";
  EXPECT_TRUE(forceForDriver(device, Quat::Identity(), Vec3(0, 0, 2)).isApprox(Vec3(0, 2, 0), 1e-12));
  device.orientation = Quat(half, 0, 0, -half);  // Force Dimension
  EXPECT_TRUE(placed(device, Vec3(1, 0, 0)).isApprox(-Vec3::UnitY(), 1e-12)) << "towards the person";
  EXPECT_TRUE(placed(device, Vec3(0, 1, 0)).isApprox(Vec3::UnitX(), 1e-12)) << "right";
  device.position_unit = 0.001;
  device.position_scale = 2.0;
  device.offset = Vec3(0, 0, 0.1);
  EXPECT_TRUE(placed(device, Vec3(0, 0, 50)).isApprox(Vec3(0, 0, 0.2), 1e-12));
}

TEST(DeviceMap, LimitsOfTheForceHoldAtTheDevice) {
  DeviceOptions device;
  device.force_scale = 0.25;
  device.position_scale = 3.0;
  HapticOptions haptics;
  haptics.max_force = 3.0;
  haptics.max_torque = 0.05;
  haptics.soft_start = 0.0;
  HapticLoop loop(limitsAtProbe(haptics, device));
  DeviceSample sample;
  ProbeSnapshot snapshot;
  snapshot.contact = true;
  snapshot.proxy = Vec3(0, 0, 1.0);  // 400 N from the coupling
  snapshot.force = Vec3(0, 0, 400.0);
  snapshot.torque = Vec3(400.0, 0, 0);  // 400 N at a lever of a metre
  double largest = 0.0, fastest = 0.0, last = 0.0;
  double largest_torque = 0.0, fastest_torque = 0.0, last_torque = 0.0;
  for (int tick = 1; tick <= 500; ++tick) {
    const double now = tick * 1e-3;
    sample.received = snapshot.taken = now;
    const Vec3 at_probe = loop.tick(sample, snapshot, false, now);
    const Wrench wrench = wrenchForDriver(device, Quat::Identity(), {at_probe, loop.torque()});
    const double force = wrench.force.norm(), torque = wrench.torque.norm();
    largest = std::max(largest, force);
    fastest = std::max(fastest, (force - last) / 1e-3);
    last = force;
    largest_torque = std::max(largest_torque, torque);
    fastest_torque = std::max(fastest_torque, (torque - last_torque) / 1e-3);
    last_torque = torque;
  }
  EXPECT_NEAR(largest_torque, haptics.max_torque, 1e-9);
  EXPECT_NEAR(fastest_torque, haptics.max_force_rate / haptics.max_force * haptics.max_torque, 1e-6);
  EXPECT_NEAR(largest, haptics.max_force, 1e-9);
  EXPECT_NEAR(fastest, haptics.max_force_rate, 1e-6);
}

/// Force on a hand that presses a device of 100 g with 1 N on a wall of 400 N/m and 0.5 N·s/m, as the
/// hand feels it, at the end of each millisecond [N]. The force acts 2 ms late.
std::vector<double> buzzOnAWall(const DeviceOptions& device) {
  constexpr int kSteps = 20;
  constexpr double kTick = 1e-3, kMass = 0.1, kOwnDamping = 0.3, kQuantum = 1e-5, kTau = 5e-3;
  const double scale = device.position_scale * device.force_scale;
  HapticOptions haptics;
  haptics.coupling_stiffness = 400.0 / scale;
  haptics.coupling_damping = 0.5 / scale;
  haptics.soft_start = 0.0;
  haptics.max_force = 20.0;
  haptics.max_force_rate = 1e5;
  haptics.passivity.loop_delay = 2e-3;
  haptics.passivity.device_damping = kOwnDamping;
  HapticLoop loop(limitsAtProbe(haptics, device));
  double z = 0.002, speed = -0.1, measured = z, filtered = 0.0;
  std::array<double, 2> on_the_way{};
  std::vector<double> felt;
  for (int tick = 1; tick <= 2000; ++tick) {
    const double now = tick * kTick, last = measured;
    measured = kQuantum * std::floor(z / kQuantum);
    filtered += (1.0 - std::exp(-kTick / kTau)) * ((measured - last) / kTick - filtered);
    DeviceSample sample;
    sample.received = now;
    sample.position = placed(device, Vec3(0, 0, measured));
    sample.velocity = placed(device, Vec3(0, 0, filtered));
    ProbeSnapshot snapshot;
    snapshot.taken = snapshot.device_received = now;
    snapshot.contact = measured < 0.0;
    snapshot.device = sample.position;
    snapshot.proxy = Vec3(0, 0, std::max(0.0, sample.position.z()));
    snapshot.force = haptics.coupling_stiffness * (snapshot.proxy - snapshot.device);
    const Vec3 at_probe = loop.tick(sample, snapshot, false, now);
    const double force = on_the_way[0];
    on_the_way = {on_the_way[1], forceForDriver(device, Quat::Identity(), at_probe).z()};
    felt.push_back(force);
    for (int k = 0; k < kSteps; ++k) {
      speed += kTick / kSteps / kMass * (force - 1.0 - kOwnDamping * speed);
      z += kTick / kSteps * speed;
    }
  }
  return felt;
}

/// The passivity options are the hand's, too: the same felt wall gives the same forces for all
/// scales. Scales are powers of two, so that rounding is the same as well.
TEST(DeviceMap, ABuzzIsStoppedInTheSameWayWhateverTheScales) {
  const std::vector<double> plain = buzzOnAWall(DeviceOptions());
  double most = 0.0;
  for (const double force : plain) most = std::max(most, force);
  EXPECT_GT(most, 1.0) << "it presses on the wall";
  for (const double force_scale : {0.25, 1.0, 4.0}) {
    for (const double position_scale : {0.5, 1.0, 2.0}) {
      DeviceOptions device;
      device.force_scale = force_scale;
      device.position_scale = position_scale;
      const std::vector<double> felt = buzzOnAWall(device);
      for (std::size_t k = 0; k < plain.size(); ++k) {
        ASSERT_NEAR(felt[k], plain[k], 1e-9 * most)
            << "force_scale " << force_scale << ", position_scale " << position_scale << ", tick " << k;
      }
    }
  }
}

TEST_F(DeviceMapTest, ForcesOutAndInAreInverse) {
  for (int k = 0; k < 100; ++k) {
    const DeviceOptions options = device();
    const Quat frame = rotation();
    const Vec3 force = vector();
    EXPECT_TRUE(forceAtProbe(options, frame, forceForDriver(options, frame, force)).isApprox(force, 1e-12));
  }
}

/// F = m a at the hand: its force and the motion that follows, for any scales.
TEST_F(DeviceMapTest, TheToolIsTheHandsWhateverTheScales) {
  for (int k = 0; k < 100; ++k) {
    const DeviceOptions options = device();
    HapticOptions haptics;
    const AdmittanceOptions at_probe = limitsAtProbe(haptics, options).admittance;
    const Vec3 force = vector();
    const Vec3 push = forceAtProbe(options, Quat::Identity(), force);
    const double acceleration = push.norm() / at_probe.mass / options.position_scale;
    EXPECT_NEAR(acceleration, force.norm() / haptics.admittance.mass, 1e-9);
    const double speed = push.norm() / at_probe.damping / options.position_scale;
    EXPECT_NEAR(speed, force.norm() / haptics.admittance.damping, 1e-9);
    EXPECT_NEAR(at_probe.max_speed / options.position_scale, haptics.admittance.max_speed, 1e-12);
  }
}

TEST(DeviceMap, WarnsOfWhatTheDeviceCannotRender) {
  DeviceOptions device;
  HapticOptions haptics;  // 400 N/m, 1 N·s/m
  EXPECT_TRUE(deviceWarnings(device, haptics).empty()) << "nothing is known of the device";
  device.max_stiffness = 400.0;
  device.max_damping = 1.0;
  EXPECT_TRUE(deviceWarnings(device, haptics).empty());
  device.position_scale = 2.0;
  const auto warnings = deviceWarnings(device, haptics);
  ASSERT_EQ(warnings.size(), 2u);
  EXPECT_NE(warnings[0].find("800 N/m"), std::string::npos) << warnings[0];
  EXPECT_NE(warnings[0].find("Set the probe's coupling_stiffness to 200 or less"), std::string::npos)
      << warnings[0];
  EXPECT_NE(warnings[1].find("Set the probe's coupling_damping to 0.5 or less"), std::string::npos)
      << warnings[1];
  device.force_scale = 0.5;
  EXPECT_TRUE(deviceWarnings(device, haptics).empty());
  haptics.max_force = 3300.0;  // millinewtons of a Touch
  EXPECT_EQ(
      deviceWarnings(device, haptics),
      std::vector<std::string>{"haptics/max_force = 3300 N is more than any haptic device exerts (250 N)"});
}

/// Result of the check for a hand that moves back and forth by 50 mm once a second (0.31 m/s at
/// most), given in `unit`.
UnitDoubt doubtOf(double per_metre, double workspace_radius, double seconds = 1.0) {
  UnitCheck check(workspace_radius);
  UnitDoubt doubt = UnitDoubt::None;
  for (double time = 0.0; time < seconds; time += 1e-3) {
    // Messages come in bursts of five at the same time, so their steps do not give the speed.
    const double received = std::floor(time * 200.0) / 200.0;
    doubt = check.look(per_metre * 0.05 * std::sin(2.0 * M_PI * time) * Vec3::UnitX(), received);
  }
  return doubt;
}

TEST(UnitCheck, KnowsMillimetresAndTenTimesTooLarge) {
  EXPECT_EQ(doubtOf(1.0, 0.0), UnitDoubt::None);
  EXPECT_EQ(doubtOf(1.0, 0.075), UnitDoubt::None);
  EXPECT_EQ(doubtOf(1.0, 0.04), UnitDoubt::None);
  EXPECT_NE(doubtOf(1000.0, 0.0), UnitDoubt::None) << "millimetres";
  EXPECT_NE(doubtOf(1000.0, 0.075, 0.01), UnitDoubt::None) << "millimetres, at once";
  EXPECT_EQ(doubtOf(10.0, 0.0), UnitDoubt::None) << "0.5 m to and fro may be a large device";
  EXPECT_EQ(doubtOf(10.0, 0.075), UnitDoubt::TooFar);
}

TEST(UnitCheck, SpeedAloneIsEnoughButNotOneJump) {
  UnitCheck check(0.0);
  for (int k = 0; k < 1000; ++k)
    EXPECT_EQ(check.look(Vec3(k < 500 ? -2.0 : 2.0, 0, 0), k * 1e-3), UnitDoubt::None);
  UnitCheck fast(0.0);
  UnitDoubt doubt = UnitDoubt::None;
  // The speed is 20 m/s, and the end is at 4 m.
  for (int k = 0; k < 200; ++k) doubt = fast.look(Vec3(0.02 * k, 0, 0), k * 1e-3);
  EXPECT_EQ(doubt, UnitDoubt::TooFast);
  EXPECT_EQ(fast.look(Vec3(4.0, 0, 0), 10.0), UnitDoubt::TooFast) << "the doubt stays";
}

TEST(UnitCheck, OneStrayPositionRaisesNoDoubt) {
  // Also a device at 0.6 m with a pose of zeros: 0.6 m is beyond the reach of one with 75 mm, 0.45 m.
  for (const double stray : {7.0, 0.0}) {
    for (const int at : {50, 0}) {
      UnitCheck check(0.075);
      for (int k = 0; k < 1000; ++k) {
        const double z = k % 100 == at ? stray : 0.6;
        EXPECT_EQ(check.look(Vec3(0, 0, z), k * 1e-3), UnitDoubt::None) << stray << ' ' << k;
      }
    }
  }
}

TEST(UnitCheck, AStrayFirstPositionHidesNoDoubt) {
  UnitCheck check(0.075);
  UnitDoubt doubt = check.look(Vec3(0, 0, 3.0), 0.0);
  for (int k = 1; k <= 20; ++k) doubt = check.look(Vec3(0, 0, 0.03 * k), 0.1 * k);  // slow, but 0.6 m
  EXPECT_EQ(doubt, UnitDoubt::TooFar);
}

TEST(UnitCheck, DiagnosticsNameTheRemedy) {
  InputCounters counters;
  counters.received = 5;
  counters.doubt = UnitDoubt::TooFar;
  FeltForce felt;
  felt.status = HapticStatus::Free;
  const auto status = probeStatus("probe", {counters}, felt, GraspState::Open, 0.0, 0.0);
  EXPECT_EQ(status.level, diagnostic_msgs::DiagnosticStatus::WARN);
  EXPECT_NE(status.message.find("device/position_unit to 0.001"), std::string::npos) << status.message;
}

/// Loads a scene, settings and files one after the other, as device.launch does.
NodeOptions load(const std::vector<fs::path>& files) {
  XmlRpcValue parameters = sceneParameters();
  for (const fs::path& file : files) {
    const YAML::Node yaml = YAML::LoadFile(file.string());
    for (const auto& entry : yaml) {
      const auto key = entry.first.as<std::string>();
      if (!entry.second.IsMap()) {
        parameters[key] = toParameter(entry.second);
        continue;
      }
      for (const auto& member : entry.second) {
        parameters[key][member.first.as<std::string>()] = toParameter(member.second);
      }
    }
  }
  return parseNodeOptions(parameters, "test");
}

std::set<std::string> names(const std::string& folder) {
  std::set<std::string> stems;
  for (const auto& entry : fs::directory_iterator(kConfig / folder))
    stems.insert(entry.path().stem().string());
  return stems;
}

/// A pose that mouse_hand sends for a place in the scene is mapped back to that place.
TEST(DeviceMap, DriversSideUndoesPlaced) {
  DeviceOptions device;
  device.position_unit = 0.001;
  device.position_scale = 2.0;
  device.offset = Vec3(0.1, -0.2, 0.3);
  device.orientation = Quat(Eigen::AngleAxisd(0.8, Vec3(1, -2, 0.5).normalized()));
  const Vec3 position(0.4, 0.5, -0.6);
  const Quat orientation(Eigen::AngleAxisd(1.3, Vec3(0, 1, 2).normalized()));
  const Pose sent = poseForDriver(device, {position, orientation});
  EXPECT_LT((placed(device, sent.position) - position).norm(), 1e-12);
  EXPECT_LT(placed(device, sent.orientation).angularDistance(orientation), 1e-7);
  // A body keeps its shape: rotating the body or the driver's axes gives the same place of its tip.
  const Vec3 tip(0.0, 0.0, 0.02);
  device.position_scale = 1.0;
  const Vec3 placed_tip = placed(device, position + orientation * tip / device.position_unit);
  EXPECT_LT((placed_tip - placed(device, position) - placed(device, orientation) * tip).norm(), 1e-12);
}

TEST(DevicePresets, EveryPairOfDeviceAndDriverLoadsWithoutWarning) {
  EXPECT_EQ(names("devices"),
            (std::set<std::string>{"touch", "omni", "premium", "omega", "sigma", "falcon", "mouse"}));
  EXPECT_GE(names("drivers").size(), 12u);
  for (const std::string& device : names("devices")) {
    for (const std::string& driver : names("drivers")) {
      SCOPED_TRACE(device + " with " + driver);
      NodeOptions options;
      ASSERT_NO_THROW(options = load({kConfig / "node.yaml", kConfig / "devices" / (device + ".yaml"),
                                      kConfig / "drivers" / (driver + ".yaml")}));
      EXPECT_TRUE(deviceWarnings(options.probes[0].device, options.probes[0].haptics).empty());
    }
  }
}

/// Limits of these models in CHAI3D 3.2, and the rule of guide/devices.md for the coupling: at most
/// half of the largest stiffness, and at most B/(T/2 + t) with T = 1 ms and the delay t = 1 ms, or
/// 2 ms over USB (Gil et al. 2009, b = 0).
TEST(DevicePresets, StayWithinThePublishedLimits) {
  struct Limits {
    double force, torque, stiffness, damping, radius, delay;
  };
  const std::map<std::string, Limits> published = {
      {"touch", {3.3, 0.0, 400, 4, 0.075, 1e-3}},     {"omni", {3.3, 0.0, 700, 5, 0.100, 1e-3}},
      {"premium", {8.5, 0.188, 800, 5, 0.120, 1e-3}}, {"omega", {12.0, 0.0, 5000, 30, 0.075, 1e-3}},
      {"sigma", {12.0, 0.2, 4000, 30, 0.075, 1e-3}},  {"falcon", {8.0, 0.0, 3000, 20, 0.040, 2e-3}}};
  for (const auto& [name, limits] : published) {
    SCOPED_TRACE(name);
    const NodeOptions options = load({kConfig / "node.yaml", kConfig / "devices" / (name + ".yaml")});
    EXPECT_EQ(options.device.max_stiffness, limits.stiffness);
    EXPECT_EQ(options.device.max_damping, limits.damping);
    EXPECT_EQ(options.device.workspace_radius, limits.radius);
    EXPECT_LE(options.haptics.max_force, limits.force);
    EXPECT_LE(options.haptics.max_torque, limits.torque);
    const double felt = feltStiffness(options.device, options.probes[0].haptics);
    EXPECT_LE(felt, 0.5 * limits.stiffness);
    EXPECT_LE(felt, feltDamping(options.device, options.probes[0].haptics) / (0.5e-3 + limits.delay) *
                        (1.0 + 1e-12));
    EXPECT_GE(options.haptics.max_force_rate, 0.99 * felt) << "a hand of 1 m/s";
  }
}

/// Computed by hand from the sources of the drivers: the middle of the workspace lies above the
/// middle of the table, up is up, and an upward force points along the driver's up.
TEST(DevicePresets, DriversAgreeOnWhereUpIs) {
  struct Driver {
    Vec3 middle, up, towards, force_up;  ///< positions in the driver's units, the force in its axes
  };
  const Vec3 x = Vec3::UnitX(), y = Vec3::UnitY(), z = Vec3::UnitZ(), none = Vec3::Zero();
  const std::map<std::string, std::pair<std::string, Driver>> drivers = {
      {"crtk", {"touch", {none, y, z, y}}},
      {"force_dimension", {"omega", {none, z, x, z}}},
      {"phantom_omni", {"omni", {none, z, -y, z}}},
      {"sensable_phantom", {"omni", {Vec3(-0.2, 0, 0), z, -x, y}}},
      {"ros_geomagic", {"touch", {none, y, z, y}}},
      {"geomagic", {"touch", {none, y, z, y}}},
      {"ros_falcon", {"falcon", {Vec3(0, 0, 0.125), y, z, y}}},
      {"falcon_ros", {"falcon", {none, y, z, y}}},
      {"haptic_ros_driver", {"omega", {none, z, x, z}}},
      {"chai3d", {"falcon", {none, z, x, z}}},
      {"spacenav", {"mouse", {none, z, -x, z}}}};
  for (const auto& [name, entry] : drivers) {
    SCOPED_TRACE(name);
    const auto& [device_name, driver] = entry;
    const DeviceOptions device =
        load({kConfig / "devices" / (device_name + ".yaml"), kConfig / "drivers" / (name + ".yaml")}).device;
    const Vec3 middle = placed(device, driver.middle);
    EXPECT_LT((middle - Vec3(0, 0, 0.09)).norm(), 1e-6) << middle.transpose();
    const double centimetre = 0.01 / device.position_unit;
    EXPECT_LT((placed(device, driver.middle + centimetre * driver.up) - middle - 0.01 * z).norm(), 1e-6);
    EXPECT_LT((placed(device, driver.middle + centimetre * driver.towards) - middle + 0.01 * y).norm(), 1e-6);
    EXPECT_LT((forceForDriver(device, Quat::Identity(), z) - driver.force_up).norm(), 1e-6);
  }
}

TEST(DeviceOptions, BadOnesAreNamed) {
  const auto messageOf = [](const std::string& yaml) {
    try {
      readDeviceOptions(ParameterGroup(toParameter(YAML::Load(yaml)), "test", "device/"));
    } catch (const InputError& error) {
      return std::string(error.what());
    }
    return std::string();
  };
  EXPECT_EQ(messageOf("{position_unit: 0.001, use_tf: false, orientation: [0.70710678, 0, 0, 0.70710678]}"),
            "");
  EXPECT_NE(messageOf("{position_unit: 0}").find("device/position_unit = 0: must be in 1e-6 to 100000"),
            std::string::npos);
  for (const std::string scale : {"-1", "1e300", "1e-9"})
    EXPECT_NE(messageOf("{force_scale: " + scale + "}").find("must be in 1e-6 to 100000"), std::string::npos);
  EXPECT_NE(messageOf("{orientation: [0, 0, 0, 0.9]}").find("device/orientation"), std::string::npos);
  EXPECT_NE(messageOf("{orientation: [0, 0, 1]}").find("must be a list of 4 finite numbers"),
            std::string::npos);
  EXPECT_NE(messageOf("{use_tf: 1}").find("device/use_tf = 1: must be true or false"), std::string::npos);
  EXPECT_NE(messageOf("{positon_scale: 1}").find("device/positon_scale: unknown parameter"),
            std::string::npos);
}

}  // namespace
}  // namespace haptic_cloth::device_map_test
