/// Processes that are killed, stopped, starved or cannot write: the device, the node, the recorder,
/// the master. Criterion: as in pose_faults_test. After the device is killed the force is zero
/// within 50 ms of the watchdog's limit (docs/architecture.md), counted in wrenches, one per
/// millisecond.
#include <geometry_msgs/Point.h>
#include <signal.h>
#include <stdlib.h>
#include <unistd.h>

#include <algorithm>
#include <thread>

#include "fault_support.h"
#include "ros/node/conversions.h"
#include "ros/node/steady_clock.h"

namespace haptic_cloth::process_faults_test {
namespace {

const std::string kFolder = std::string(HAPTIC_CLOTH_SOURCE_DIR) + "/test/ros/";
const std::string kScene = kFolder + "support/scene.yaml", kSlowStart = kFolder + "faults/slow_start.yaml";

/// A ramp with more missed ticks than this is not a measurement.
constexpr int kMissed = 5;

/// The master of this test.
OwnMaster& master() {
  static OwnMaster instance;
  return instance;
}

class ProcessFaultTest : public FaultTest {
 protected:
  void TearDown() override {
    FaultTest::TearDown();
    if (cloth_) end(*cloth_);
    ros::param::del("/cloth");
  }

  /// Sends SIGINT, so that roslaunch ends what it has started.
  static void end(Process& process) {
    process.signal(SIGINT);
    if (process.wait() < 0) ADD_FAILURE() << process.output();
  }

  /// Starts the node. @param before words before its command  @param after shell text after it
  void startNode(const std::string& before = "", const std::string& after = "") {
    const std::string program = programDirectory() + "/haptic_cloth_node";
    const std::string command =
        "exec " + before + " '" + program + "' __name:=cloth '_scene_file:=" + kScene + "' " + after;
    cloth_ = std::make_unique<Process>(std::vector<std::string>{"sh", "-c", command});
  }

  std::string diagnosed(const std::string& key) const { return diagnostics_.value("haptic thread", key); }

  std::unique_ptr<Process> cloth_;
};

/// Findings in the wrenches after the last pose.
struct RampDown {
  /// Ticks from the first that answers the last pose to the last before the force falls.
  int watched = 0;
  int ramp = 0;  ///< further ticks until the force is zero
  /// Ticks at either end whose wrenches were lost; the counts above may be too high by them.
  int missed = 0;
  double seconds = 0.0;    ///< duration of both, by time of arrival
  double strongest = 0.0;  ///< [N]
};

RampDown rampDown(const std::vector<HeardWrench>& wrenches) {
  const ros::Time stamp = wrenches.back().stamp;
  const auto answers = [&](const HeardWrench& wrench) { return wrench.stamp == stamp; };
  const auto none = [](const HeardWrench& wrench) { return wrench.force.isZero(0.0); };
  const auto first = std::find_if(wrenches.begin() + 1, wrenches.end(), answers);
  const auto zero = std::find_if(first, wrenches.end(), none);
  // The ramp: the wrenches that fall steadily until zero.
  auto falls = zero;
  while (falls != first && (falls - 1)->force.norm() > falls->force.norm()) --falls;
  RampDown found;
  found.missed =
      static_cast<int>((zero->number - (zero - 1)->number - 1) + (first->number - (first - 1)->number - 1));
  found.watched = static_cast<int>(falls->number - (first - 1)->number) - 1;
  found.ramp = static_cast<int>(zero->number - falls->number);
  found.seconds = zero->received - first->received;
  for (auto wrench = first; wrench != zero; ++wrench) {
    found.strongest = std::max(found.strongest, wrench->force.norm());
  }
  return found;
}

/// The last wrench before those of another node; the end if all are from one node.
std::vector<HeardWrench>::const_iterator lastOfFirstNode(const std::vector<HeardWrench>& wrenches) {
  const auto other = [](const HeardWrench& a, const HeardWrench& b) { return a.connection != b.connection; };
  return std::adjacent_find(wrenches.begin(), wrenches.end(), other);
}

class DeviceKilledTest : public ProcessFaultTest {
 protected:
  /// Lets a device press and kills it.
  void killDevice(int number, ros::Publisher& target, RampDown& found) {
    target.publish(toPoint(kAbove));
    const auto device = startHand("device_" + std::to_string(number), kAbove);
    ASSERT_TRUE(waitFor([this] { return diagnostics_.value("probe", "status") == "free"; }));
    target.publish(toPoint(Vec3(0.0, 0.0, 0.080)));  // so deep that the force reaches 3.3 N
    ASSERT_TRUE(waitFor([this] { return reaction_.force().z() > 1.0; }));
    sleepUntil(steadyNow() + 0.3);
    reaction_.clear();
    sleepUntil(steadyNow() + 0.1);
    device->signal(SIGKILL);
    device->wait();
    ASSERT_TRUE(waitFor([this] { return reaction_.force().isZero(0.0); }));
    found = rampDown(reaction_.all());
    EXPECT_TRUE(waitFor([this] { return diagnostics_.value("probe", "status") == "pose stale"; }));
  }
};

TEST_F(DeviceKilledTest, LeavesNoForce) {
  startNode();
  press();
  hand_.reset();  // the poses of another process follow
  ros::Publisher target = node_.advertise<geometry_msgs::Point>("hand/target", 1, true);
  int measured = 0;
  for (int k = 0; k < 10 && measured < 3; ++k) {
    RampDown found;
    killDevice(k, target, found);
    if (HasFatalFailure()) return;
    if (found.missed > kMissed) continue;  // the machine was too busy for a measurement
    EXPECT_GT(found.strongest, 0.5);
    EXPECT_LE(found.watched + found.ramp, 50 + 50);
    const std::string name = "_" + std::to_string(measured++);
    RecordProperty("watched_ticks" + name, found.watched);
    RecordProperty("ramp_ticks" + name, found.ramp);
    RecordProperty("missed_ticks" + name, found.missed);
    RecordProperty("ms" + name, std::to_string(1e3 * found.seconds));
    RecordProperty("N" + name, std::to_string(found.strongest));
  }
  EXPECT_EQ(measured, 3) << "too many wrenches were lost to measure anything";
  EXPECT_GE(count("force off: poses stopped"), 3.0);
  target.shutdown();
  press();
}

TEST_F(ProcessFaultTest, AKilledNodeComesBackByItself) {
  cloth_ = std::make_unique<Process>(
      std::vector<std::string>{"roslaunch", "haptic_cloth", "haptic_cloth.launch", "respawn:=true",
                               "output:=log", "scene:=" + kScene, "settings:=" + kSlowStart});
  ASSERT_TRUE(waitFor([] { return pidOf("/haptic_cloth") > 0; }, 2.0 * kPatience)) << cloth_->output();
  press();
  for (const int signal : {SIGTERM, SIGKILL}) {
    SCOPED_TRACE(signal);
    const pid_t pid = pidOf("/haptic_cloth");
    ASSERT_GT(pid, 0);
    reaction_.clear();
    ASSERT_TRUE(waitFor([&] { return !reaction_.all().empty(); }));
    const double start = steadyNow();
    kill(pid, signal);
    ASSERT_TRUE(waitFor([&] { return pidOf("/haptic_cloth") != pid && pidOf("/haptic_cloth") > 0; }));
    std::vector<HeardWrench> heard;
    ASSERT_TRUE(waitFor([&] {
      heard = reaction_.all();
      return lastOfFirstNode(heard) != heard.end();
    }));
    const auto last = lastOfFirstNode(heard), first = last + 1;
    const std::string name = signal == SIGTERM ? "SIGTERM" : "SIGKILL";
    RecordProperty(name + "_last_N", std::to_string(last->force.norm()));
    RecordProperty(name + "_first_N", std::to_string(first->force.norm()));
    RecordProperty(name + "_first_number", static_cast<int>(first->number));
    RecordProperty(name + "_silent_s", std::to_string(first->received - start));
    if (signal == SIGTERM) {
      EXPECT_TRUE(last->force.isZero(0.0)) << "zero must be the last";
    }
    // The first wrench of the new node may be missed: a subscriber of the old node connects about
    // 200 ticks after the new one starts, and that node feels the hand by then. The slow soft start
    // still separates this force from a full one.
    HapticOptions limits;
    limits.soft_start = 30.0;
    EXPECT_LE(first->force.norm(), strongestAt(first->number, limits))
        << "a new node begins with zero; this is its wrench number " << first->number;
    EXPECT_TRUE(recovers());
  }
}

TEST_F(ProcessFaultTest, ASlowRampIsNotCutShortByTheEnd) {
  HapticOptions limits;
  limits.max_force_rate = 0.4;  // [N/s]: from 0.25 N to zero takes 0.6 s
  startNode("", "_haptics/max_force_rate:=0.4");
  press();
  ASSERT_TRUE(waitFor([this] { return reaction_.force().z() > 0.25; }));
  reaction_.clear();
  cloth_->signal(SIGTERM);
  EXPECT_EQ(cloth_->wait(), 0) << cloth_->output();
  EXPECT_TRUE(waitFor([this] { return reaction_.force().isZero(0.0); }));
  const WrenchFindings found = examine(reaction_.all(), limits);
  EXPECT_EQ(found.too_fast, 0) << "up to " << found.fastest << " N a tick";
  ros::param::del("/cloth");
  startNode();
  press();
}

TEST_F(ProcessFaultTest, AStoppedNodeGoesOn) {
  startNode();
  press();
  for (int k = 0; k < 3; ++k) {
    cloth_->signal(SIGSTOP);
    sleepUntil(steadyNow() + 0.5);
    cloth_->signal(SIGCONT);
    EXPECT_TRUE(recovers());
  }
  // At least half of 3 x 500 ticks, whatever the time of the signals.
  EXPECT_TRUE(waitFor([this] { return diagnostics_.number("haptic thread", "ticks given up") > 750.0; }));
  RecordProperty("given_up", diagnosed("ticks given up"));
}

class StarvedTest : public ProcessFaultTest, public testing::WithParamInterface<bool> {};

TEST_P(StarvedTest, BusyCores) {
  // Without the capability the haptic thread gets no real-time priority, as on most users'
  // machines.
  startNode(GetParam() || geteuid() != 0 ? "" : "setpriv --bounding-set=-sys_nice");
  press();
  {
    std::vector<std::unique_ptr<Process>> others;
    for (unsigned k = 0; k < 4 * std::max(1U, std::thread::hardware_concurrency()); ++k) {
      others.push_back(
          std::make_unique<Process>(std::vector<std::string>{"sh", "-c", "while :; do :; done"}));
    }
    reaction_.clear();
    for (int k = 0; k < 2; ++k) freshDiagnostics();
    RecordProperty("scheduling", diagnosed("scheduling"));
    RecordProperty("rate_Hz", diagnosed("rate [Hz]"));
    RecordProperty("late_p50_us", diagnosed("late p50 [us]"));
    RecordProperty("late_p99_us", diagnosed("late p99 [us]"));
    RecordProperty("given_up", diagnosed("ticks given up"));
    RecordProperty("real_time_factor", diagnostics_.value("solver", "real-time factor"));
    const long seen = reaction_.count();
    EXPECT_TRUE(waitFor([&] { return reaction_.count() > seen + 1000; }));
    RecordProperty("stops_solver", static_cast<int>(count("force off: solver stalled")));
    RecordProperty("stops_poses", static_cast<int>(count("force off: poses stopped")));
  }
  EXPECT_TRUE(recovers());
  EXPECT_NE(diagnosed("scheduling"), "");
}

std::string schedulingName(const testing::TestParamInfo<bool>& info) {
  return info.param ? "AsItMay" : "WithoutPriority";
}
INSTANTIATE_TEST_SUITE_P(Priority, StarvedTest, testing::Values(true, false), schedulingName);

TEST_F(ProcessFaultTest, AFullDiskStopsTheRecorderAlone) {
  startNode("", ">/dev/full 2>&1");
  press();
  char folder[] = "/tmp/haptic_cloth_test_XXXXXX";
  ASSERT_NE(mkdtemp(folder), nullptr);
  const std::string bag = std::string(folder) + "/full.bag";
  ASSERT_EQ(symlink("/dev/full", (bag + ".active").c_str()), 0);
  reaction_.clear();
  Process recorder({"rosrun", "rosbag", "record", "--buffsize=1", "--chunksize=1", "-O", bag,
                    "/probe/reaction", "/cloth/markers", "/cloth/state"});
  EXPECT_GT(recorder.wait(), 0) << "a recorder on a full disk must say so\n" << recorder.output();
  RecordProperty("recorder", recorder.output().substr(0, 300));
  EXPECT_TRUE(feels());
  EXPECT_TRUE(recovers());
  unlink((bag + ".active").c_str());
  unlink(bag.c_str());
  EXPECT_EQ(rmdir(folder), 0);
}

// This test must be last, because this process, too, is unknown to the new master.
TEST_F(ProcessFaultTest, AKilledMasterIsNotFelt) {
  startNode();
  press();
  freshDiagnostics();
  reaction_.clear();
  const double renewed = diagnostics_.number("display", "registrations renewed");
  master().kill();
  const long seen = diagnostics_.count();
  EXPECT_TRUE(waitFor([&] { return diagnostics_.count() > seen + 3; }));
  const std::vector<HeardWrench> heard = reaction_.all();
  const auto felt = std::count_if(heard.begin(), heard.end(),
                                  [](const HeardWrench& wrench) { return wrench.force.z() > 0.05; });
  EXPECT_GT(felt, 0.8 * static_cast<double>(heard.size())) << "the master took the force away";
  master().start();
  EXPECT_TRUE(waitFor([&] { return diagnostics_.number("display", "registrations renewed") > renewed; }));
  EXPECT_TRUE(master().knowsService("/cloth/reset"));
  EXPECT_TRUE(recovers());
  Process echo({"rostopic", "echo", "-n1", "/probe/reaction"});
  EXPECT_EQ(echo.wait(), 0) << echo.output();
}

}  // namespace
}  // namespace haptic_cloth::process_faults_test

int main(int argc, char** argv) {
  if (haptic_cloth::isHand(argc, argv)) return haptic_cloth::runHand(argc, argv);
  setenv("ROS_MASTER_URI", haptic_cloth::process_faults_test::master().uri().c_str(), 1);
  testing::InitGoogleTest(&argc, argv);
  ros::init(argc, argv, "ros_process_faults_test");
  return RUN_ALL_TESTS();
}
