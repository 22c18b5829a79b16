/// The pure functions between ROS and the library: conversions, markers, diagnostics.
#include "ros/node/conversions.h"

#include <gtest/gtest.h>
#include <tf2_ros/buffer.h>
#include <yaml-cpp/yaml.h>

#include <array>
#include <cmath>
#include <limits>

#include "haptic_cloth/error.h"
#include "haptic_cloth/machine.h"
#include "haptic_cloth/simulation.h"
#include "ros/display/diagnostics.h"
#include "ros/display/markers.h"
#include "ros/node/steady_clock.h"
#include "ros/options/node_options.h"
#include "ros/programs/hand_model.h"
#include "ros/support/yaml_parameters.h"
#include "support/scenes.h"

namespace haptic_cloth::conversions_test {
namespace {

using XmlRpc::XmlRpcValue;

constexpr double kNaN = std::numeric_limits<double>::quiet_NaN();

TEST(Conversions, PointAndPoseKeepEveryBit) {
  const Vec3 position(1.0 / 3.0, -2e-17, 3e5);
  EXPECT_EQ(toVec3(toPoint(position)), position);
  const Quat turned(Eigen::AngleAxisd(0.7, Vec3(1, 2, 3).normalized()));
  EXPECT_EQ(toQuat(toPose(position, turned).orientation).coeffs(), turned.coeffs());
}

TEST(Conversions, FiniteAndUnit) {
  geometry_msgs::Pose pose = toPose(Vec3(1, 2, 3));
  EXPECT_TRUE(isFinite(pose));
  pose.orientation.y = kNaN;
  EXPECT_FALSE(isFinite(pose));
  pose = toPose(Vec3(1, std::numeric_limits<double>::infinity(), 3));
  EXPECT_FALSE(isFinite(pose));
  geometry_msgs::Quaternion orientation;
  EXPECT_FALSE(isUnit(orientation));
  orientation.w = 1.05;
  EXPECT_TRUE(isUnit(orientation));
  orientation.w = 1.2;
  EXPECT_FALSE(isUnit(orientation));
}

TEST(Conversions, Transformed) {
  geometry_msgs::TransformStamped transform;
  transform.transform.translation.z = 1.0;
  transform.transform.rotation.z = transform.transform.rotation.w = std::sqrt(0.5);
  const Pose frame = toPose(transform);
  // 90 degrees about x, then 90 degrees about z: the pose's z axis goes to -y and from there to x.
  const Quat about_x(Eigen::AngleAxisd(0.5 * M_PI, Vec3::UnitX()));
  const Pose there = composed(frame, {Vec3(1, 0, 0), about_x});
  EXPECT_TRUE(there.position.isApprox(Vec3(0, 1, 1), 1e-12));
  EXPECT_TRUE((there.orientation * Vec3::UnitZ()).isApprox(Vec3::UnitX(), 1e-12));
}

TEST(Conversions, Wrench) {
  const auto wrench = toWrench({Vec3(1, 2, 3), Vec3(4, 5, 6)}, ros::Time(5, 6), "frame");
  EXPECT_EQ(wrench.wrench.force.y, 2.0);
  EXPECT_EQ(wrench.wrench.torque.x, 4.0);
  EXPECT_EQ(wrench.wrench.torque.z, 6.0);
  EXPECT_EQ(wrench.header.stamp, ros::Time(5, 6));
  EXPECT_EQ(wrench.header.frame_id, "frame");
}

TEST(Conversions, YamlOfEveryType) {
  XmlRpcValue tree;
  tree["b"] = true;
  tree["i"] = -7;
  tree["d"] = 0.1;
  tree["s"] = std::string("a \"b\": [c]\n\\");
  tree["late_number"] = std::string("1e-3");
  tree["list"][0] = 1.5;
  tree["list"][1] = std::string("two");
  tree["map"]["inner"] = 1e300;
  tree["empty"].setSize(0);
  const YAML::Node node = YAML::Load(toYaml(tree, "test", ""));
  EXPECT_TRUE(node["b"].as<bool>());
  EXPECT_EQ(node["i"].as<int>(), -7);
  EXPECT_EQ(node["d"].as<double>(), 0.1);
  EXPECT_EQ(node["s"].as<std::string>(), "a \"b\": [c]\n\\");
  EXPECT_EQ(node["late_number"].as<double>(), 1e-3);
  EXPECT_EQ(node["list"][1].as<std::string>(), "two");
  EXPECT_EQ(node["map"]["inner"].as<double>(), 1e300);
  EXPECT_EQ(node["empty"].size(), 0u);
  XmlRpcValue binary(const_cast<char*>("x"), 1);
  EXPECT_THROW(toYaml(binary, "test", "key"), InputError);
}

TEST(Conversions, Overrides) {
  XmlRpcValue tree;
  tree["probe"]["radius"] = 0.5;
  tree["cloth"]["particles"][0] = 17;
  tree["cloth"]["particles"][1] = 33;
  EXPECT_EQ(toOverrides(tree, "test"),
            (std::vector<std::string>{"cloth.particles=[17, 33]", "probe.radius=0.5"}));
  EXPECT_TRUE(toOverrides(XmlRpcValue(), "test").empty());
}

TEST(Conversions, ClothState) {
  DisplayFrame frame;
  frame.time = 2.5;
  for (int i = 0; i < 9; ++i) frame.positions.push_back(Vec3(i, 2 * i, 3 * i));
  // Two cells of a 3 x 3 grid that share the side (1, 4).
  frame.cells = {{{0, 1, 3, 4}, 0, false}, {{1, 2, 4, 5}, 0, false}};
  frame.tension = {1.0F, 2.0F};
  frame.bending = {3.0F, 4.0F};
  frame.last.self_contacts = 7;
  frame.last.min_self_gap = 2e-4;
  frame.failed.note(Termination::NotFinite, 1.0);
  frame.failed.note(Termination::OutOfReach, 2.0);
  ClothState state;
  std::vector<int> scratch;
  toClothState(frame, 3, 3, scratch, state);
  toClothState(frame, 3, 3, scratch, state);
  EXPECT_EQ(state.particles, (std::vector<std::uint32_t>{0, 1, 3, 4, 2, 5}));
  EXPECT_EQ(state.corners, (std::vector<std::uint32_t>{0, 1, 2, 3, 1, 4, 3, 5}));
  EXPECT_EQ(state.positions[3 * 4 + 1], 4.0F);
  EXPECT_EQ(state.tension[1], 2.0F);
  EXPECT_EQ(state.self_contacts, 7u);
  EXPECT_EQ(state.min_self_gap, 2e-4);
  EXPECT_EQ(state.failed_steps, 2u);
  EXPECT_EQ(state.out_of_reach, 1u);
}

class MarkersTest : public testing::Test {
 protected:
  MarkersTest() {
    XmlRpcValue parameters = sceneParameters();
    const YAML::Node obstacles = YAML::Load(
        "[{shape: box, size: [0.1, 0.2, 0.3]}, {shape: sphere, radius: 0.05}, {shape: plane},"
        " {shape: cylinder, radius: 0.02, length: 0.3}, {shape: capsule, radius: 0.02, length: 0.3}]");
    parameters["obstacles"] = toParameter(obstacles);
    scene_ = parseNodeOptions(parameters, "test").scene;
    Simulation simulation(scene_);
    simulation.positions(frame_.positions);
    simulation.cells(frame_.cells);
    frame_.probes.resize(scene_.probes.size());
    for (const Obstacle& obstacle : scene_.obstacles) frame_.obstacles.push_back(obstacle.pose);
  }
  Scene scene_;
  DisplayFrame frame_;
};

/// Folded over, cloth shows its back. Whoever looks from above sees the lines all the same.
TEST_F(MarkersTest, LinesAreSeenFromAboveOnTheBackToo) {
  MarkerBuilder builder(scene_, "world", MarkerOptions());
  const double height = frame_.positions[0].z();
  for (const char* side : {"front", "back"}) {
    const auto mesh = builder.build(frame_, {Vec3::Zero()}, ros::Time(1.0)).markers[1];
    ASSERT_FALSE(mesh.points.empty());
    for (const geometry_msgs::Point& point : mesh.points) ASSERT_GT(point.z, height) << side;
    for (Vec3& position : frame_.positions) position.x() = -position.x();
  }
}

TEST_F(MarkersTest, CountsStayTheSameForEveryMesh) {
  MarkerBuilder builder(scene_, "world", MarkerOptions());
  const auto first = builder.build(frame_, {Vec3::Zero()}, ros::Time(1.0));
  frame_.cells = {{{0, 16, 16 * 17, 17 * 17 - 1}, 4, false}};  // one coarse cell
  const auto second = builder.build(frame_, {Vec3(0, 0, 1)}, ros::Time(2.0));
  ASSERT_EQ(first.markers.size(), second.markers.size());
  for (std::size_t k = 0; k < 2; ++k) {
    EXPECT_EQ(first.markers[k].points.size(), second.markers[k].points.size());
    EXPECT_EQ(first.markers[k].points.size(), first.markers[k].colors.size());
  }
  EXPECT_EQ(first.markers[0].points.size() % 3, 0u);
  EXPECT_EQ(first.markers[1].points.size() % 2, 0u);
}

TEST_F(MarkersTest, EveryMarkerIsOneThatRvizTakes) {
  MarkerBuilder builder(scene_, "world", MarkerOptions());
  std::set<std::pair<std::string, int>> names;
  for (const auto& marker : builder.build(frame_, {Vec3(0, 0, 1)}, ros::Time(1.0)).markers) {
    EXPECT_TRUE(names.emplace(marker.ns, marker.id).second);
    EXPECT_TRUE(isUnit(marker.pose.orientation));
    EXPECT_TRUE(isFinite(marker.pose));
    EXPECT_GT(marker.scale.x, 0.0);
    EXPECT_EQ(marker.header.frame_id, "world");
    for (const auto& point : marker.points) ASSERT_TRUE(toVec3(point).allFinite());
  }
  // Surface, mesh, probe, proxy, force, quality; box, sphere, plane, cylinder, and a capsule of three parts.
  EXPECT_EQ(names.size(), 6u + 7u);
}

TEST_F(MarkersTest, ATextSaysWhatIsGivenUp) {
  MarkerBuilder builder(scene_, "world", MarkerOptions());
  const Vec3 on_hand(0.0, 0.0, 1.5);
  const auto text = [&] { return builder.build(frame_, {on_hand}, ros::Time(1.0)).markers.back(); };
  EXPECT_EQ(text().action, visualization_msgs::Marker::DELETE);
  frame_.quality.rung = 5;
  frame_.quality.given_up = "tolerance 1, steps to 2 ms, mesh thresholds x 5 beyond 4 cells of probes";
  frame_.probes[0].report.force = Vec3(0.0, 0.0, 3.0);  // on the probe
  frame_.probes[0].force_error = 0.03;
  EXPECT_EQ(text().action, visualization_msgs::Marker::ADD);
  EXPECT_EQ(text().text,
            "reduced quality (rung 5):\n"
            "tolerance 1, steps to 2 ms, mesh\nthresholds x 5 beyond 4 cells of probes\n"
            "probe: force 1.50 N, error 0.03 N");
  EXPECT_GT(text().pose.position.z, frame_.positions[0].z());
}

TEST_F(MarkersTest, TheForceArrowPointsAlongTheForce) {
  MarkerBuilder builder(scene_, "world", MarkerOptions());
  frame_.probes[0].report.present = true;
  frame_.probes[0].report.proxy = Vec3(0.1, 0.2, 0.3);
  const auto& arrow = builder.build(frame_, {Vec3(0, 0, 2.0)}, ros::Time(1.0)).markers[4];
  EXPECT_EQ(arrow.action, visualization_msgs::Marker::ADD);
  EXPECT_TRUE((toVec3(arrow.points[1]) - toVec3(arrow.points[0])).isApprox(Vec3(0, 0, 0.1), 1e-12));
  EXPECT_EQ(builder.build(frame_, {Vec3::Zero()}, ros::Time(1.0)).markers[4].action,
            visualization_msgs::Marker::DELETE);
}

TEST_F(MarkersTest, CapsulesAndObstaclesStandWhereTheyAre) {
  scene_.probes.resize(2);
  scene_.probes[1].name = "finger";
  scene_.probes[1].radius = 0.01;
  scene_.probes[1].length = 0.04;
  frame_.probes.resize(2);
  ProbeView& finger = frame_.probes[1];
  finger.report.present = true;
  finger.report.proxy = Vec3(0.1, 0.2, 0.3);
  finger.report.orientation = lyingAlong(Vec3::UnitX());
  const Pose moved{Vec3(1, 2, 3), Quat(Eigen::AngleAxisd(0.5 * M_PI, Vec3::UnitX()))};
  frame_.obstacles[0] = moved;
  MarkerBuilder builder(scene_, "world", MarkerOptions());
  const auto parts = [&](const std::string& name) {
    std::vector<visualization_msgs::Marker> markers;
    for (const auto& marker : builder.build(frame_, {Vec3::Zero(), Vec3::Zero()}, ros::Time(1.0)).markers) {
      if (marker.ns == name) markers.push_back(marker);
    }
    return markers;
  };
  const auto proxy = parts("finger/proxy");
  ASSERT_EQ(proxy.size(), 3u);
  EXPECT_EQ(proxy[0].scale.z, 0.04);
  EXPECT_TRUE(toVec3(proxy[1].pose.position).isApprox(Vec3(0.08, 0.2, 0.3), 1e-12));
  EXPECT_TRUE(toVec3(proxy[2].pose.position).isApprox(Vec3(0.12, 0.2, 0.3), 1e-12));
  EXPECT_LT(parts("probe/proxy")[0].scale.x, 1e-5) << "not there";
  const auto box = parts("obstacles")[0];
  EXPECT_EQ(toVec3(box.pose.position), moved.position);
  EXPECT_EQ(toQuat(box.pose.orientation).coeffs(), moved.orientation.coeffs());

  const auto colour = [&](GraspState grasp) {
    finger.grasp = grasp;
    const auto color = parts("finger/proxy")[0].color;
    return std::array<float, 3>{color.r, color.g, color.b};
  };
  EXPECT_NE(colour(GraspState::Open), colour(GraspState::Closed));
  EXPECT_NE(colour(GraspState::Closed), colour(GraspState::Holding));
}

/// Value of a key of a status; empty: there is none.
std::string value(const diagnostic_msgs::DiagnosticStatus& status, const std::string& key) {
  for (const auto& entry : status.values) {
    if (entry.key == key) return entry.value;
  }
  return std::string("no " + key);
}

TEST(Diagnostics, LevelsSayWhatIsWrong) {
  using diagnostic_msgs::DiagnosticStatus;
  EXPECT_EQ(solverStatus(SolverStats(), false, 10.0).level, DiagnosticStatus::WARN);
  EXPECT_EQ(solverStatus(SolverStats(), true, 10.0).level, DiagnosticStatus::OK);
  SolverStats solver;
  solver.taken = 9.5;
  EXPECT_EQ(solverStatus(solver, false, 10.0).level, DiagnosticStatus::OK);

  EXPECT_EQ(value(solverStatus(solver, false, 10.0), "processor"), processorName());
  EXPECT_EQ(value(solverStatus(solver, false, 10.0), "instruction set"), instructionSet());
  EXPECT_EQ(value(solverStatus(solver, false, 10.0), "given up"), "nothing");
  solver.quality = {2, "tolerance 1", 0.004, 0.5};
  EXPECT_EQ(solverStatus(solver, false, 10.0).message, "running with tolerance 1");
  EXPECT_EQ(value(solverStatus(solver, false, 10.0), "quality rung"), "2");
  EXPECT_EQ(value(solverStatus(solver, false, 10.0), "step length [s]"), "0.004");
  EXPECT_EQ(value(solverStatus(solver, false, 10.0), "slipped [s]"), "0.5");
  solver.slipped_share = 0.04;
  EXPECT_EQ(solverStatus(solver, false, 10.0).level, DiagnosticStatus::OK);
  solver.slipped_share = 0.98;
  EXPECT_EQ(solverStatus(solver, false, 10.0).level, DiagnosticStatus::WARN);
  EXPECT_EQ(solverStatus(solver, false, 10.0).message,
            "too slow, 98 % of the time slips; running with tolerance 1");
  solver.slipped_share = 0.0;
  solver.steps = 100;
  solver.wall = 1.0;
  solver.real_time_factor = 1.0;
  for (const std::string rate : {"steps per second", "real-time factor"}) {
    EXPECT_NE(value(solverStatus(solver, false, 10.0), rate), "0");
    EXPECT_EQ(value(solverStatus(solver, true, 10.0), rate), "0");  // paused
  }

  // A failed step is a warning for 5 s (docs/architecture.md, time limits); the counts remain.
  for (const auto& [why, word] : {std::pair{Termination::NotFinite, "not finite"},
                                  std::pair{Termination::OutOfReach, "may have met unseen"}}) {
    solver.failed.note(why, 9.0);
    const DiagnosticStatus failed = solverStatus(solver, false, 10.0);
    EXPECT_EQ(failed.level, DiagnosticStatus::WARN);
    EXPECT_NE(failed.message.find(word), std::string::npos) << failed.message;
    solver.taken = 14.0;
    EXPECT_EQ(solverStatus(solver, false, 14.5).level, DiagnosticStatus::OK) << "long ago";
    solver.taken = 9.5;
  }
  EXPECT_EQ(value(solverStatus(solver, false, 10.0), "failed steps"), "2");
  EXPECT_EQ(value(solverStatus(solver, false, 10.0), "failed: parts may have met"), "1");

  EXPECT_EQ(value(solverStatus(solver, false, 10.0), "self-contact"), "on");
  EXPECT_EQ(value(solverStatus(solver, false, 10.0), "smallest gap of layers [mm]"), "inf");
  solver.last.self_contacts = 12;
  solver.last.min_self_gap = 2.5e-4;
  EXPECT_EQ(value(solverStatus(solver, false, 10.0), "contacts between layers"), "12");
  EXPECT_EQ(value(solverStatus(solver, false, 10.0), "smallest gap of layers [mm]"), "0.25");
  solver.meets_itself = false;
  EXPECT_EQ(value(solverStatus(solver, false, 10.0), "self-contact"), "off: layers pass through each other");

  HapticStats haptic;
  haptic.taken = 9.5;
  haptic.wall = 1.0;
  haptic.rate = 1000.0;
  haptic.ticks = 1000;
  EXPECT_EQ(hapticStatus(haptic, "SCHED_FIFO", 10.0).level, DiagnosticStatus::OK);
  haptic.ticks = 800;
  EXPECT_EQ(hapticStatus(haptic, "SCHED_FIFO", 10.0).level, DiagnosticStatus::WARN);
  EXPECT_EQ(hapticStatus(haptic, "SCHED_FIFO", 20.0).level, DiagnosticStatus::ERROR);

  InputCounters counters;
  FeltForce felt;
  const auto probe = [&] { return probeStatus("thumb", {counters}, felt, GraspState::Closed, 0.25, 10.0); };
  EXPECT_EQ(probe().level, DiagnosticStatus::OK);
  EXPECT_EQ(probe().name, "thumb");
  EXPECT_EQ(value(probe(), "error of the force, estimated [N]"), "0.25");
  counters.received = 5;
  EXPECT_EQ(probe().message, "the poses stopped; no force") << "none was usable";
  felt.status = HapticStatus::Free;
  EXPECT_EQ(probe().level, DiagnosticStatus::OK);
  for (int k = 0; k < 2; ++k) counters.drop(counters.late, 9.9);
  EXPECT_EQ(probe().level, DiagnosticStatus::WARN);
  EXPECT_EQ(probe().message, "2 poses dropped, the last: late");
  felt.status = HapticStatus::PoseStale;
  counters.drop(counters.unknown_frame, 9.9);
  EXPECT_EQ(probe().message, "3 poses dropped, the last: unknown frame; no force") << "they have not stopped";
  counters.last_dropped = 9.0;
  EXPECT_EQ(probe().message, "the poses stopped; no force");
  felt.status = HapticStatus::Free;
  EXPECT_EQ(probe().level, DiagnosticStatus::WARN) << "what was dropped lately must be seen";
  counters.last_dropped = 1.0;
  EXPECT_EQ(probe().level, DiagnosticStatus::OK) << "long ago";
  for (const HapticStatus stopped : {HapticStatus::PoseStale, HapticStatus::SnapshotStale}) {
    felt.status = stopped;
    EXPECT_EQ(probe().level, DiagnosticStatus::WARN);
  }
  felt.status = HapticStatus::Free;
  felt.stopped = 6.0;
  EXPECT_EQ(probe().level, DiagnosticStatus::WARN) << "4 s ago";
  EXPECT_EQ(probe().message, "the force was off within the last 5 s");
  felt.stopped = 4.0;
  EXPECT_EQ(probe().level, DiagnosticStatus::OK) << "6 s ago";
  counters.transform_age = 0.5;
  EXPECT_EQ(probe().level, DiagnosticStatus::OK);
  counters.transform_age = 2.0;
  EXPECT_EQ(probe().level, DiagnosticStatus::WARN);
  EXPECT_EQ(probe().message, "the transform of the device's frame is old");
  EXPECT_EQ(value(probe(), "age of the transform [s]"), "2");
  counters.transform_age = 0.0;
  EXPECT_EQ(value(probe(), "share of the force passed on [%]"), "100");
  FeltForce resumed;
  resumed.note(HapticStatus::Paused, Wrench());
  resumed.note(HapticStatus::SnapshotStale, Wrench());
  EXPECT_EQ(resumed.snapshot_stops, 0u) << "the first step after a pause is yet to come";
  resumed.note(HapticStatus::Contact, Wrench());
  resumed.note(HapticStatus::SnapshotStale, Wrench());
  EXPECT_EQ(resumed.snapshot_stops, 1u);
  FeltForce weak;
  weak.note(HapticStatus::Contact, Wrench(), 0.95);
  EXPECT_LT(weak.weakened, 0.0);
  weak.note(HapticStatus::Contact, Wrench(), 0.45);
  weak.note(HapticStatus::Free, Wrench(), 1.0);
  EXPECT_NEAR(weak.weakened, steadyNow(), 1.0);
  felt.weakened = 6.0;
  EXPECT_EQ(probe().level, DiagnosticStatus::WARN) << "4 s ago";
  EXPECT_EQ(probe().message, "the force was weakened, against a buzz or for its error, within the last 5 s");
  felt.weakened = 4.0;
  EXPECT_EQ(probe().level, DiagnosticStatus::OK) << "6 s ago";
  felt.status = HapticStatus::Paused;
  EXPECT_EQ(probe().message, "paused");
  felt.status = HapticStatus::Inside;
  EXPECT_EQ(probe().message, "the probe appeared in the cloth; move it clear of it once");
  counters.last_dropped = 9.0;
  EXPECT_EQ(probe().message, "the probe appeared in the cloth; move it clear of it once")
      << "that is why now";
  counters.last_dropped = 1.0;
  EXPECT_EQ(value(probe(), "status"), "inside the cloth");
  felt.status = HapticStatus::Free;
  counters.bad_turn = 6.0;
  EXPECT_EQ(probe().message, "quaternions that are not of length 1; the probe does not turn");
  counters.bad_turn = 4.0;
  const DiagnosticStatus shared =
      probeStatus("thumb", {counters}, felt, GraspState::Open, 0.0, 10.0, "/other");
  EXPECT_EQ(shared.level, DiagnosticStatus::WARN);
  EXPECT_EQ(shared.message, "the device also gets messages of /other");
  counters.last_dropped = 9.0;
  EXPECT_EQ(probeStatus("thumb", {counters}, felt, GraspState::Open, 0.0, 10.0, "/other").message,
            "the device also gets messages of /other; 3 poses dropped, the last: unknown frame");
  EXPECT_EQ(displayStatus(0, 0, false, 0).level, DiagnosticStatus::WARN);
}

TEST(Diagnostics, OfAnAdmittanceDeviceKnowItsPosesToo) {
  InputCounters poses, forces;
  FeltForce felt;
  felt.status = HapticStatus::NoForce;
  const auto status = [&] { return probeStatus("arm", {poses, &forces}, felt, GraspState::Open, 0.0, 10.0); };
  EXPECT_EQ(status().message, "no force yet");
  poses.receive(9.9);
  poses.drop(poses.unknown_frame, 9.9);
  EXPECT_EQ(status().message, "1 poses dropped, the last: unknown frame; no force");
  forces.receive(9.9);
  felt.status = HapticStatus::NoPose;
  EXPECT_EQ(status().message, "1 poses dropped, the last: unknown frame; no force");
  EXPECT_EQ(value(status(), "poses dropped: unknown frame"), "1");
  EXPECT_EQ(value(status(), "dropped"), "0") << "no force was";
  poses.last_dropped = 9.0;
  EXPECT_EQ(status().message, "the poses stopped; no force") << "none was usable";
  felt.status = HapticStatus::Free;
  poses.last_dropped = 1.0;
  EXPECT_EQ(status().message, "receiving");
  felt.status = HapticStatus::ForceStale;
  EXPECT_EQ(status().message, "the forces stopped; no force");
}

TEST(Diagnostics, OfAnObstacleSayWhetherItMoves) {
  using diagnostic_msgs::DiagnosticStatus;
  const tf2_ros::Buffer transforms;
  Mailbox<ObstacleTarget> shared;
  geometry_msgs::PoseStamped pose;
  pose.pose = toPose(Vec3(0.0, 0.0, 0.5));
  for (const Shape shape : {Shape::Box, Shape::Sphere}) {
    Obstacle obstacle;
    obstacle.shape = shape;
    ObstacleInput input(obstacle, FrameLookup("world", transforms), shared);
    const auto status = [&](double now) { return obstacleStatus("table", input.counters(), now); };
    EXPECT_EQ(status(100.0).message, "no pose yet");
    input.accept(pose, 100.0);
    EXPECT_EQ(status(101.0).message, "receiving");
    EXPECT_EQ(status(103.0).message, "stands still: no pose for 2 s");
    EXPECT_EQ(status(103.0).level, DiagnosticStatus::OK);
    geometry_msgs::PoseStamped without_turn = pose;
    without_turn.pose.orientation.w = 0.0;
    input.accept(without_turn, 104.0);
    EXPECT_EQ(status(105.0).level, shape == Shape::Box ? DiagnosticStatus::WARN : DiagnosticStatus::OK)
        << "a sphere cannot be seen to turn";
  }
}

TEST(Frames, SayWhenTheirNewestTransformWasSent) {
  tf2_ros::Buffer transforms;
  transforms.setUsingDedicatedThread(true);
  geometry_msgs::TransformStamped sent;
  sent.header.frame_id = "world";
  sent.transform.rotation.w = 1.0;
  const FrameLookup frames("world", transforms);
  sent.child_frame_id = "arm";
  for (const double time : {5.0, 7.5}) {
    sent.header.stamp = ros::Time(time);
    transforms.setTransform(sent, "test");
  }
  EXPECT_EQ(frames.find("arm")->stamp, ros::Time(7.5));
  sent.child_frame_id = "base";
  transforms.setTransform(sent, "test", true);
  EXPECT_TRUE(frames.find("base")->stamp.isZero()) << "it does not change";
  EXPECT_TRUE(frames.find("")->stamp.isZero());
  EXPECT_FALSE(frames.find("nowhere"));
}

TEST(Diagnostics, AnObstaclesDroppedPoseIsForgivenWhenPosesAreGoodAgain) {
  // A warning for 5 s, as for a probe and in docs/architecture.md; the count remains.
  using diagnostic_msgs::DiagnosticStatus;
  const tf2_ros::Buffer transforms;
  Mailbox<ObstacleTarget> shared;
  ObstacleInput table(Obstacle(), FrameLookup("world", transforms), shared);
  const auto level = [&](double now) { return obstacleStatus("table", table.counters(), now).level; };
  geometry_msgs::PoseStamped good;
  good.pose = toPose(Vec3(0.0, 0.0, 0.5));
  geometry_msgs::PoseStamped not_finite = good, lost = good, far = good;
  not_finite.pose.position.z = std::numeric_limits<double>::quiet_NaN();
  far.pose.position.z = 1e300;
  lost.header.frame_id = "nowhere";
  table.accept(good, 100.0);
  EXPECT_EQ(level(100.0), DiagnosticStatus::OK);
  double time = 100.0;
  for (const auto& [bad, reason] :
       {std::pair{not_finite, "not finite"}, {lost, "unknown frame"}, {far, "too far"}}) {
    time += 100.0;
    table.accept(bad, time);
    EXPECT_EQ(level(time + 0.1), DiagnosticStatus::WARN);
    const std::string message = obstacleStatus("table", table.counters(), time + 0.1).message;
    EXPECT_NE(message.find(std::string("the last: ") + reason), std::string::npos) << message;
    table.accept(good, time + 1.0);
    EXPECT_EQ(level(time + 4.9), DiagnosticStatus::WARN) << "what was dropped lately must be seen";
    EXPECT_EQ(level(time + 5.1), DiagnosticStatus::OK);
  }
  EXPECT_EQ(table.counters().dropped(), 3u);
  EXPECT_EQ(shared.read().number, 4u) << "the good ones were taken";
}

TEST(HandModel, TheWillIsContinuousAndRepeats) {
  const HandOptions options;
  Vec3 last = handTarget(options, 0.0);
  EXPECT_EQ(last, options.start);
  bool pressed = false;
  for (double time = 0.0; time < 20.0; time += 1e-3) {
    const Vec3 target = handTarget(options, time);
    // The fastest move is 9 cm in 1 s with a smooth step, whose peak speed is 1.5 times the mean.
    EXPECT_LT((target - last).norm(), 2e-4) << time;
    pressed = pressed || target == options.press;
    last = target;
  }
  EXPECT_TRUE(pressed);
}

/// Criterion: at any rate the hand overshoots its target by no more than its damping ratio of 0.73
/// allows, 4 % of the way.
TEST(HandModel, IsStableAtAnyRate) {
  const HandOptions options;
  for (const double rate : {1e-3, 1.0, 10.0, 25.0, 40.0, 100.0, 1000.0}) {
    HandModel hand(options);
    double lowest = options.start.z();
    for (int i = 0; i < 2000; ++i)
      lowest = std::min(lowest, hand.step(options.press, Vec3::Zero(), 1.0 / rate).z());
    EXPECT_GE(lowest, options.press.z() - 0.04 * (options.start.z() - options.press.z())) << rate << " Hz";
    EXPECT_LE(lowest, options.press.z() + 1e-6) << rate << " Hz";
  }
}

TEST(HandModel, ReactionAndWillBalance) {
  HandOptions options;
  HandModel hand(options);
  Vec3 position;
  for (int i = 0; i < 5000; ++i) position = hand.step(options.start, Vec3(0, 0, 1.5), 1e-3);
  EXPECT_NEAR(position.z() - options.start.z(), 1.5 / options.stiffness, 1e-9);
}

}  // namespace
}  // namespace haptic_cloth::conversions_test
