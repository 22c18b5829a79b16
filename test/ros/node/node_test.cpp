/// The running node from outside: topics, rates, services, and its response to bad poses.
#include <geometry_msgs/TransformStamped.h>
#include <gtest/gtest.h>
#include <haptic_cloth/ClothState.h>
#include <haptic_cloth/LoadState.h>
#include <haptic_cloth/SaveState.h>
#include <ros/callback_queue.h>
#include <ros/ros.h>
#include <std_srvs/Empty.h>
#include <std_srvs/SetBool.h>
#include <sys/stat.h>
#include <tf2_ros/static_transform_broadcaster.h>
#include <visualization_msgs/MarkerArray.h>

#include <algorithm>
#include <cmath>
#include <filesystem>
#include <fstream>
#include <limits>
#include <memory>
#include <string>
#include <vector>

#include "haptic_cloth/state_file.h"
#include "ros/display/flow_meter.h"
#include "ros/node/conversions.h"
#include "ros/node/steady_clock.h"
#include "ros/support/ros_test_support.h"
#include "support/state_cases.h"

namespace haptic_cloth::node_test {
namespace {

const Vec3 kAbove(0.0, 0.0, 0.125);    ///< free: the radius is 10 mm, the cloth at 0.10 m
const Vec3 kPressed(0.0, 0.0, 0.100);  ///< the probe's lowest point is 10 mm below the flat cloth

class NodeTest : public testing::Test {
 protected:
  NodeTest() : spinner_(2), reaction_(node_, "probe/reaction"), diagnostics_(node_) { spinner_.start(); }

  void SetUp() override {
    ASSERT_TRUE(waitFor([this] { return reaction_.count() > 0; })) << "the node does not run";
    pause(false);
    reset();
  }
  void TearDown() override {
    const long seen = reaction_.count();
    EXPECT_TRUE(waitFor([&] { return reaction_.count() > seen; })) << "the node died";
    EXPECT_TRUE(reaction_.finite());
  }

  void reset() {
    std_srvs::Empty empty;
    ASSERT_TRUE(ros::service::call("/haptic_cloth/reset", empty));
  }
  void pause(bool paused) {
    std_srvs::SetBool request;
    request.request.data = paused;
    ASSERT_TRUE(ros::service::call("/haptic_cloth/pause", request));
    ASSERT_TRUE(request.response.success);
  }
  double input(const std::string& key) { return diagnostics_.number("probe", key); }
  /// Waits until `key` of the probe's diagnostics equals `value`.
  bool inputBecomes(const std::string& key, double value) {
    return waitFor([&] { return input(key) == value; });
  }
  /// Waits for diagnostics made after this call.
  void freshDiagnostics() {
    const long seen = diagnostics_.count();
    ASSERT_TRUE(waitFor([&] { return diagnostics_.count() > seen + 1; }));
  }

  ros::NodeHandle node_;
  ros::AsyncSpinner spinner_;
  ReactionListener reaction_;
  DiagnosticsListener diagnostics_;
};

/// One tick per millisecond by the wrenches' own numbers and stamps. Ticks may be caught up within
/// 20 ms. Later ones are given up and counted, except for one tick and a fraction each time.
TEST_F(NodeTest, ZeroForceFlowsAtOneKilohertzWithoutAnyPose) {
  constexpr double kRate = 1000.0, kBacklog = 0.02;
  const auto givenUp = [&] {
    freshDiagnostics();
    freshDiagnostics();  // the statistics cover a second, too
    return diagnostics_.number("haptic thread", "ticks given up");
  };
  const double before = givenUp();
  const std_msgs::Header first = reaction_.last().header;
  const long seen = reaction_.count();
  ASSERT_TRUE(waitFor([&] { return reaction_.count() > seen + 2000; }));
  const std_msgs::Header last = reaction_.last().header;
  const double given_up = givenUp() - before;
  const double ticks = last.seq - first.seq, due = kRate * (last.stamp - first.stamp).toSec();
  EXPECT_LE(ticks, due + kRate * kBacklog + 1.0);
  EXPECT_GE(ticks + given_up + 2.0 * given_up / (kRate * kBacklog), due - kRate * kBacklog - 1.0);
  EXPECT_EQ(reaction_.force(), Vec3::Zero());
  EXPECT_EQ(reaction_.last().header.frame_id, "world");
  EXPECT_FALSE(reaction_.last().header.stamp.isZero());
}

TEST_F(NodeTest, MarkersAreMadeForListenersOnly) {
  freshDiagnostics();
  const double before = diagnostics_.number("display", "marker frames");
  freshDiagnostics();
  EXPECT_EQ(diagnostics_.number("display", "marker frames"), before);

  std::atomic<int> frames{0}, changed{0};
  std::size_t surface = 0, mesh = 0;
  ros::Subscriber subscriber = node_.subscribe<visualization_msgs::MarkerArray>(
      "cloth/markers", 1, [&](const visualization_msgs::MarkerArray::ConstPtr& array) {
        ASSERT_GE(array->markers.size(), 5u);
        if (frames > 0) changed += surface != array->markers[0].points.size();
        surface = array->markers[0].points.size();
        mesh = array->markers[1].points.size();
        EXPECT_EQ(array->markers[0].colors.size(), surface);
        ++frames;
      });
  ASSERT_TRUE(waitFor([&] { return frames >= 30; }));
  EXPECT_EQ(changed, 0);
  EXPECT_EQ(surface, 16u * 16u * 6u);
  EXPECT_EQ(mesh, 2u * (2u * 16u * 16u + 32u));
}

TEST_F(NodeTest, TheStateIsAWholeMesh) {
  std::mutex mutex;
  ClothState state;
  std::atomic<int> count{0};
  ros::Subscriber subscriber =
      node_.subscribe<ClothState>("cloth/state", 1, [&](const ClothState::ConstPtr& message) {
        const std::lock_guard<std::mutex> lock(mutex);
        state = *message;
        ++count;
      });
  ASSERT_TRUE(waitFor([&] { return count >= 5; }));
  const std::lock_guard<std::mutex> lock(mutex);
  EXPECT_EQ(state.columns, 17u);
  EXPECT_EQ(state.rows, 17u);
  ASSERT_GT(state.particles.size(), 0u);
  EXPECT_EQ(state.positions.size(), 3 * state.particles.size());
  EXPECT_EQ(state.corners.size(), 4 * state.levels.size());
  EXPECT_EQ(state.tension.size(), state.levels.size());
  EXPECT_EQ(state.bending.size(), state.levels.size());
  double area = 0.0;
  for (const auto level : state.levels) area += std::pow(4.0, level);
  EXPECT_EQ(area, 256.0) << "leaves must tile the cloth";
  for (const auto corner : state.corners) ASSERT_LT(corner, state.particles.size());
  for (const float coordinate : state.positions) ASSERT_TRUE(std::isfinite(coordinate));
}

/// Criterion: picture and state that a new subscriber gets first are copies from after it came, by
/// their stamps; the cloth has moved on since the reset before each test.
TEST_F(NodeTest, TheFirstFrameIsNotFromBeforeItsSubscriber) {
  ros::Duration(1.0).sleep();  // without subscribers
  const ros::Time begin = ros::Time::now();
  std::atomic<double> age{0.0}, state{0.0}, picture{0.0};
  const ros::Subscriber states =
      node_.subscribe<ClothState>("cloth/state", 1, [&](const ClothState::ConstPtr& message) {
        if (state != 0.0) return;
        age = message->time;
        state = secondsBetween(begin, message->header.stamp);
      });
  const ros::Subscriber pictures = node_.subscribe<visualization_msgs::MarkerArray>(
      "cloth/markers", 1, [&](const visualization_msgs::MarkerArray::ConstPtr& message) {
        if (picture == 0.0) picture = secondsBetween(begin, message->markers.at(0).header.stamp);
      });
  ASSERT_TRUE(waitFor([&] { return state != 0.0 && picture != 0.0; }));
  EXPECT_GT(state, 0.0);
  EXPECT_GT(picture, 0.0);
  EXPECT_GT(age, 0.0);
}

TEST_F(NodeTest, PressingIsFeltUpwardsAndLettingGoIsFree) {
  TestDevice device(node_, kAbove);
  ASSERT_TRUE(waitFor([&] { return diagnostics_.value("probe", "status") == "free"; }));
  EXPECT_EQ(reaction_.force(), Vec3::Zero());
  device.moveTo(kPressed);
  ASSERT_TRUE(waitFor([&] { return reaction_.force().z() > 0.1; })) << "nothing felt";
  device.moveTo(kAbove);
  EXPECT_TRUE(waitFor([&] { return device.arrived() && reaction_.force().isZero(0.0); }));
}

/// What `monitor` prints of a probe without a device, with one, and when the device has left.
TEST_F(NodeTest, TheFlowMeterTellsWhetherAProbeIsPresent) {
  ros::CallbackQueue queue;
  ros::NodeHandle own;
  own.setCallbackQueue(&queue);
  FlowMeter meter(own, {"probe"}, 0.0, 0.0);
  const auto says = [&](const std::string& text) {
    return waitFor([&] {
      queue.callAvailable();
      return meter.missing().empty() && meter.line(1.0).find(text) != std::string::npos;
    });
  };
  EXPECT_TRUE(says("proxy absent"));
  {
    TestDevice device(node_, kAbove);
    EXPECT_TRUE(says("proxy z  125.0 mm"));
  }
  EXPECT_TRUE(says("proxy absent"));
}

TEST_F(NodeTest, TheWrenchCarriesThePosesStamp) {
  ros::Publisher publisher = node_.advertise<geometry_msgs::PoseStamped>("probe/pose", 1);
  ASSERT_TRUE(waitFor([&] { return publisher.getNumSubscribers() > 0; }));
  geometry_msgs::PoseStamped pose;
  pose.pose = toPose(kAbove);
  pose.header.stamp = ros::Time::now();
  publisher.publish(pose);
  EXPECT_TRUE(waitFor([&] { return reaction_.last().header.stamp == pose.header.stamp; }));
}

TEST_F(NodeTest, ASilentDeviceFeelsNothing) {
  TestDevice device(node_, kAbove);
  ASSERT_TRUE(waitFor([&] { return diagnostics_.value("probe", "status") == "free"; }));
  device.moveTo(kPressed);
  ASSERT_TRUE(waitFor([&] { return reaction_.force().z() > 0.1; }));
  device.silence();
  EXPECT_TRUE(waitFor([&] { return reaction_.force().isZero(0.0); }));
  EXPECT_TRUE(waitFor([&] { return diagnostics_.value("probe", "status") == "pose stale"; }));
}

TEST_F(NodeTest, PauseStopsTimeAndForce) {
  TestDevice device(node_, kAbove);
  ASSERT_TRUE(waitFor([&] { return diagnostics_.value("probe", "status") == "free"; }));
  device.moveTo(kPressed);
  // A hand that moves far during the pause would have to be lifted first.
  ASSERT_TRUE(waitFor([&] { return device.arrived() && reaction_.force().z() > 0.1; }));
  pause(true);
  EXPECT_TRUE(waitFor([&] { return reaction_.force().isZero(0.0); }));

  std::atomic<double> time{-1.0};
  std::atomic<int> count{0};
  ros::Subscriber subscriber =
      node_.subscribe<ClothState>("cloth/state", 1, [&](const ClothState::ConstPtr& m) {
        time = m->time;
        ++count;
      });
  ASSERT_TRUE(waitFor([&] { return count > 5; })) << "paused, the cloth must still be shown";
  const double paused_at = time;
  const int seen = count;
  ASSERT_TRUE(waitFor([&] { return count > seen + 5; }));
  EXPECT_EQ(time, paused_at);
  EXPECT_TRUE(reaction_.force().isZero(0.0));
  pause(false);
  EXPECT_TRUE(waitFor([&] { return time > paused_at; }));
  EXPECT_TRUE(waitFor([&] { return reaction_.force().z() > 0.1; }));
}

TEST_F(NodeTest, ResetStartsAgain) {
  std::atomic<double> time{-1.0};
  ros::Subscriber subscriber = node_.subscribe<ClothState>(
      "cloth/state", 1, [&](const ClothState::ConstPtr& message) { time = message->time; });
  ASSERT_TRUE(waitFor([&] { return time > 0.5; }));
  pause(true);
  reset();
  EXPECT_TRUE(waitFor([&] { return time == 0.0; }));
}

/// Calls a service that reports its result. @return its message, with "failed: " before it if it
/// failed
template <class Service>
std::string call(const std::string& name, const std::string& file) {
  Service service;
  service.request.file = file;
  if (!ros::service::call("/haptic_cloth/" + name, service)) return "no answer";
  return (service.response.success ? "" : "failed: ") + service.response.message;
}

/// A folder for the states of a test.
struct Folder {
  Folder()
      : path(std::filesystem::temp_directory_path() / ("haptic_cloth_node_" + std::to_string(getpid()))) {
    std::filesystem::create_directories(path);
  }
  ~Folder() { std::filesystem::remove_all(path); }
  std::string file(const std::string& name) const { return (path / name).string(); }
  std::filesystem::path path;
};

TEST_F(NodeTest, GoesOnFromASavedStateWithoutAHandInIt) {
  const Folder folder;
  std::mutex mutex;
  ClothState newest;
  std::atomic<double> time{-1.0};
  std::atomic<int> states{0};
  ros::Subscriber subscriber =
      node_.subscribe<ClothState>("cloth/state", 1, [&](const ClothState::ConstPtr& message) {
        const std::lock_guard<std::mutex> lock(mutex);
        newest = *message;
        time = message->time;
        ++states;
      });
  TestDevice device(node_, kAbove);
  ASSERT_TRUE(waitFor([&] { return diagnostics_.value("probe", "status") == "free"; }));
  device.moveTo(kPressed);
  ASSERT_TRUE(waitFor([&] { return reaction_.force().z() > 0.1; }));
  ASSERT_EQ(call<SaveState>("save_state", folder.file("pressed")).find("saved "), 0u);
  EXPECT_TRUE(waitFor([&] { return reaction_.force().z() > 0.1; })) << "saving must not end the press";

  // During a pause the state does not change.
  device.silence();
  pause(true);
  ASSERT_TRUE(waitFor([&] { return reaction_.force().isZero(0.0); }));
  ASSERT_EQ(call<LoadState>("load_state", folder.file("pressed")).find("loaded "), 0u);
  ASSERT_EQ(call<SaveState>("save_state", folder.file("paused")).find("saved "), 0u);
  const int seen = states;  // some of these may still be from the cloth before
  ASSERT_TRUE(waitFor([&] { return states >= seen + 4; }));
  mutex.lock();
  const ClothState then = newest;
  mutex.unlock();

  pause(false);
  ASSERT_TRUE(waitFor([&] { return time > then.time + 0.2; }));
  pause(true);
  ASSERT_EQ(call<LoadState>("load_state", folder.file("paused")).find("loaded "), 0u);
  ASSERT_TRUE(waitFor([&] { return time == then.time; }));
  mutex.lock();
  EXPECT_EQ(newest.positions, then.positions);
  EXPECT_EQ(newest.particles, then.particles);
  mutex.unlock();

  // The hand is inside the loaded cloth: it feels nothing until the probe has been clear of it.
  pause(false);
  device.resume();
  ASSERT_TRUE(waitFor([&] { return diagnostics_.value("probe", "status") == "free"; }));
  EXPECT_EQ(reaction_.force(), Vec3::Zero());
  device.moveTo(kAbove);
  ASSERT_TRUE(waitFor([&] { return device.arrived(); }));
  device.moveTo(kPressed);
  EXPECT_TRUE(waitFor([&] { return reaction_.force().z() > 0.1; }));
}

TEST_F(NodeTest, RefusesStatesThatDoNotFitAndGoesOn) {
  const Folder folder;
  std::ofstream(folder.file("notes")) << "no state";
  const auto expect = [](const std::string& message, const std::string& word) {
    EXPECT_EQ(message.find("failed: "), 0u) << message;
    EXPECT_NE(message.find(word), std::string::npos) << message;
  };
  expect(call<LoadState>("load_state", folder.file("absent")), "No such file");
  expect(call<LoadState>("load_state", folder.file("notes")), "does not begin");
  expect(call<LoadState>("load_state", ""), "must have a name");
  expect(call<SaveState>("save_state", folder.file("notes")), "would be lost");
  expect(call<SaveState>("save_state", folder.file("none/here")), "No such file");
  expect(call<SaveState>("save_state", "/dev/full"), "regular file");
  expect(call<SaveState>("save_state", ""), "must have a name");
  // Files that could deliver endless bytes, or none for ever, are not opened.
  ASSERT_EQ(mkfifo(folder.file("fifo").c_str(), 0600), 0);
  for (const std::string& file : {folder.file("fifo"), std::string("/dev/null"), folder.path.string()}) {
    expect(call<LoadState>("load_state", file), "must be a regular file");
    expect(call<SaveState>("save_state", file), "must be a regular file");
  }
  // A relative name refers to the working directory of the node, not of the caller; the answer has
  // the full path.
  const std::string saved = call<SaveState>("save_state", "haptic_cloth_node_test.state");
  const std::string::size_type end = saved.find(',');
  ASSERT_EQ(saved.find("saved /"), 0u) << saved;
  EXPECT_TRUE(std::filesystem::remove(saved.substr(6, end - 6))) << saved;
  std::atomic<double> time{-1.0};
  ros::Subscriber subscriber = node_.subscribe<ClothState>(
      "cloth/state", 1, [&](const ClothState::ConstPtr& message) { time = message->time; });
  ASSERT_TRUE(waitFor([&] { return time > 0.0; }));
  const double now = time;
  EXPECT_TRUE(waitFor([&] { return time > now; }));
}

TEST_F(NodeTest, RefusesClothThatPassesThroughItselfAndKeepsItsOwn) {
  const Folder folder;
  pause(true);
  ASSERT_EQ(call<SaveState>("save_state", folder.file("good")).find("saved "), 0u);
  std::vector<StateEntry> entries = stateEntries(readStateFile(folder.file("good")));
  foldThrough(entries, 0.10, 0.01);
  std::ofstream(folder.file("crossed"), std::ios::binary) << sealState(entries);

  const std::string answer = call<LoadState>("load_state", folder.file("crossed"));
  EXPECT_EQ(answer.find("failed: "), 0u) << answer;
  for (const char* words : {"crossed: cloth = ", " crossings, first of cells (", ") at [",
                            "must not pass through itself", "cannot untangle"}) {
    EXPECT_NE(answer.find(words), std::string::npos) << answer;
  }
  ASSERT_EQ(call<SaveState>("save_state", folder.file("after")).find("saved "), 0u);
  EXPECT_TRUE(readStateFile(folder.file("after")) == readStateFile(folder.file("good")))
      << "its own was lost";
  pause(false);
}

TEST_F(NodeTest, BadPosesAreDroppedAndCounted) {
  ros::Publisher publisher = node_.advertise<geometry_msgs::PoseStamped>("probe/pose", 1);
  ASSERT_TRUE(waitFor([&] { return publisher.getNumSubscribers() > 0; }));
  freshDiagnostics();
  const double received = input("received");
  // One at a time, because a queue of one would lose poses.
  double sent = 0.0;
  const auto send = [&](const geometry_msgs::PoseStamped& pose) {
    publisher.publish(pose);
    ++sent;
    return inputBecomes("received", received + sent);
  };
  geometry_msgs::PoseStamped good;
  good.header.frame_id = "world";
  good.header.stamp = ros::Time::now();
  good.pose = toPose(kAbove);

  const double not_finite = input("dropped: not finite"), unknown = input("dropped: unknown frame");
  const double late = input("dropped: late"), order = input("dropped: out of order");
  const double quaternion = input("taken: bad quaternion");

  geometry_msgs::PoseStamped pose = good;
  pose.pose.position.x = std::numeric_limits<double>::quiet_NaN();
  ASSERT_TRUE(send(pose));
  EXPECT_EQ(input("dropped: not finite"), not_finite + 1);

  pose = good;
  pose.header.stamp = ros::Time::now();
  pose.header.frame_id = "nowhere";
  ASSERT_TRUE(send(pose));
  EXPECT_EQ(input("dropped: unknown frame"), unknown + 1);

  pose = good;
  pose.header.stamp = ros::Time::now() - ros::Duration(10.0);
  ASSERT_TRUE(send(pose));
  EXPECT_EQ(input("dropped: late"), late + 1);

  pose = good;
  pose.header.stamp = ros::Time::now();
  pose.pose.orientation.w = 0.0;
  ASSERT_TRUE(send(pose));
  EXPECT_EQ(input("taken: bad quaternion"), quaternion + 1);
  EXPECT_EQ(reaction_.last().header.stamp, pose.header.stamp) << "a sphere needs no orientation";

  // A stamp in the future (within the possible offset of a device's clock) makes the next pose out
  // of order. Poses are sent in pairs, because any stamp is good after a silence; the node's queue
  // may lose one of a pair.
  EXPECT_TRUE(waitFor([&] {
    pose = good;
    pose.header.stamp = ros::Time::now() + ros::Duration(5.0);
    publisher.publish(pose);
    sleepUntil(steadyNow() + 5e-3);
    pose.header.stamp -= ros::Duration(0.5);
    publisher.publish(pose);
    sleepUntil(steadyNow() + 0.1);
    return input("dropped: out of order") > order;
  }));

  // A stamp more than a second back means that the clock was set: the node starts again with it.
  pose.header.stamp = ros::Time::now();
  publisher.publish(pose);
  EXPECT_TRUE(waitFor([&] { return reaction_.last().header.stamp == pose.header.stamp; }));
  EXPECT_TRUE(reaction_.force().isZero(0.0));
}

TEST_F(NodeTest, PosesOfAKnownFrameAreTransformed) {
  tf2_ros::StaticTransformBroadcaster broadcaster;
  geometry_msgs::TransformStamped transform;
  transform.header.frame_id = "world";
  transform.header.stamp = ros::Time::now();
  transform.child_frame_id = "device_base";
  transform.transform.translation.z = 0.2;
  transform.transform.rotation.x = 1.0;  // half a turn about x: y and z are reversed
  broadcaster.sendTransform(transform);

  std::mutex mutex;
  Vec3 proxy(0.0, 0.0, 0.0);
  ros::Subscriber subscriber = node_.subscribe<geometry_msgs::PoseStamped>(
      "probe/proxy", 1, [&](const geometry_msgs::PoseStamped::ConstPtr& message) {
        const std::lock_guard<std::mutex> lock(mutex);
        proxy = toVec3(message->pose.position);
      });
  ros::Publisher publisher = node_.advertise<geometry_msgs::PoseStamped>("probe/pose", 1);
  geometry_msgs::PoseStamped pose;
  pose.header.frame_id = "device_base";
  pose.pose = toPose(Vec3(0.01, 0.02, 0.03));
  EXPECT_TRUE(waitFor([&] {
    pose.header.stamp = ros::Time::now();
    publisher.publish(pose);
    const std::lock_guard<std::mutex> lock(mutex);
    // The proxy follows the device through a spring, so a millimetre is close enough.
    return (proxy - Vec3(0.01, -0.02, 0.17)).norm() < 1e-3;
  })) << "proxy at "
      << proxy.transpose();

  // Down in the world is up in this frame. The wrench is given in this frame and pushes back.
  double height = 0.200 - kAbove.z();
  EXPECT_TRUE(waitFor([&] {
    pose.header.stamp = ros::Time::now();
    pose.pose = toPose(Vec3(0.0, 0.0, height));
    publisher.publish(pose);
    if (diagnostics_.value("probe", "status") != "no pose") height = std::min(height + 5e-4, 0.100);
    return reaction_.force().z() < -0.1;
  })) << "force "
      << reaction_.force().transpose();
  EXPECT_EQ(reaction_.last().header.frame_id, "device_base");
}

}  // namespace
}  // namespace haptic_cloth::node_test

int main(int argc, char** argv) {
  testing::InitGoogleTest(&argc, argv);
  ros::init(argc, argv, "ros_node_test");
  return RUN_ALL_TESTS();
}
