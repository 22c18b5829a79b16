#include "fault_support.h"

#include <dirent.h>
#include <geometry_msgs/Point.h>
#include <ros/master.h>
#include <ros/network.h>
#include <unistd.h>
#include <xmlrpcpp/XmlRpcClient.h>

#include <algorithm>
#include <cstdlib>
#include <fstream>

#include "ros/node/conversions.h"
#include "ros/node/steady_clock.h"

namespace haptic_cloth {
namespace {

constexpr double kLateTicks = 5.0;  ///< periods of the rate limit that a late tick may use [-]
constexpr double kRoundOff = 1e-9;  ///< [N], [N·m]
constexpr double kFelt = 0.1;       ///< smallest force that a hand notices [N]
/// Longest wait in one press before the hand is lifted again [s].
constexpr double kDownAndUp = 4.0;

}  // namespace

double strongestAt(std::uint32_t number, const HapticOptions& limits) {
  const double rate = std::min(limits.max_force_rate, limits.max_force / limits.soft_start);
  return std::min(limits.max_force, number * kLateTicks * rate / limits.rate);
}

WrenchFindings examine(const std::vector<HeardWrench>& wrenches, const HapticOptions& limits) {
  WrenchFindings found;
  const double step = kLateTicks * limits.max_force_rate / limits.rate;
  const double torque_step = step / limits.max_force * limits.max_torque;
  const HeardWrench* last = nullptr;
  for (const HeardWrench& wrench : wrenches) {
    ++found.heard;
    if (!wrench.force.allFinite() || !wrench.torque.allFinite()) ++found.not_finite;
    found.strongest = std::max(found.strongest, wrench.force.norm());
    found.too_strong += wrench.force.norm() > limits.max_force + kRoundOff ||
                        wrench.torque.norm() > limits.max_torque + kRoundOff;
    if (last != nullptr && wrench.number > last->number) {
      const double ticks = wrench.number - last->number;
      const double change = (wrench.force - last->force).norm() / ticks;
      found.lost += static_cast<long>(ticks) - 1;
      found.fastest = std::max(found.fastest, change);
      const double torque_change = (wrench.torque - last->torque).norm() / ticks;
      found.too_fast += change > step + kRoundOff || torque_change > torque_step + kRoundOff;
    } else {
      ++found.starts;
      found.too_early += wrench.force.norm() > strongestAt(wrench.number, limits) + kRoundOff;
    }
    last = &wrench;
  }
  return found;
}

ReactionRecord::ReactionRecord(ros::NodeHandle& node, const std::string& topic) {
  using Event = ros::MessageEvent<const geometry_msgs::WrenchStamped>;
  ros::SubscribeOptions options;
  options.initByFullCallbackType<const Event&>(topic, 1000, [this](const Event& event) {
    const geometry_msgs::WrenchStamped& message = *event.getMessage();
    const auto& [force, torque] = message.wrench;
    const std::lock_guard<std::mutex> lock(mutex_);
    last_ = {message.header.seq,
             message.header.stamp,
             Vec3(force.x, force.y, force.z),
             Vec3(torque.x, torque.y, torque.z),
             steadyNow(),
             event.getConnectionHeaderPtr()};
    wrenches_.push_back(last_);
    ++count_;
  });
  options.transport_hints = ros::TransportHints().tcpNoDelay();
  subscriber_ = node.subscribe(options);
}

std::vector<HeardWrench> ReactionRecord::all() const {
  const std::lock_guard<std::mutex> lock(mutex_);
  return wrenches_;
}

void ReactionRecord::clear() {
  const std::lock_guard<std::mutex> lock(mutex_);
  wrenches_.clear();
}

HeardWrench ReactionRecord::last() const {
  const std::lock_guard<std::mutex> lock(mutex_);
  return last_;
}

bool isHand(int argc, char** argv) { return argc >= 6 && std::string(argv[1]) == "--hand"; }

int runHand(int argc, char** argv) {
  ros::init(argc, argv, argv[2]);
  ros::NodeHandle node;
  TestDevice device(node, Vec3(std::atof(argv[3]), std::atof(argv[4]), std::atof(argv[5])));
  const ros::Subscriber target = node.subscribe<geometry_msgs::Point>(
      "hand/target", 1, [&](const geometry_msgs::Point::ConstPtr& point) { device.moveTo(toVec3(*point)); });
  ros::spin();
  return 0;
}

std::unique_ptr<Process> startHand(const std::string& name, const Vec3& start) {
  return std::make_unique<Process>(
      std::vector<std::string>{"/proc/self/exe", "--hand", name, std::to_string(start.x()),
                               std::to_string(start.y()), std::to_string(start.z())});
}

pid_t pidOf(const std::string& node) {
  XmlRpc::XmlRpcValue request, response, uri;
  request[0] = ros::this_node::getName();
  request[1] = node;
  if (!ros::master::execute("lookupNode", request, response, uri, false)) return -1;
  std::string host;
  std::uint32_t port = 0;
  if (!ros::network::splitURI(static_cast<std::string>(uri), host, port)) return -1;
  XmlRpc::XmlRpcClient client(host.c_str(), static_cast<int>(port), "/");
  XmlRpc::XmlRpcValue caller, answer;
  caller[0] = ros::this_node::getName();
  if (!client.execute("getPid", caller, answer) || client.isFault()) return -1;
  if (answer.getType() != XmlRpc::XmlRpcValue::TypeArray || answer.size() < 3) return -1;
  return static_cast<int>(answer[2]);
}

double residentMemory(pid_t pid) {
  std::ifstream stream("/proc/" + std::to_string(pid) + "/statm");
  double total = 0.0, resident = 0.0;
  stream >> total >> resident;
  return resident * static_cast<double>(sysconf(_SC_PAGESIZE)) * 1e-6;
}

int openFiles(pid_t pid) {
  DIR* folder = opendir(("/proc/" + std::to_string(pid) + "/fd").c_str());
  if (folder == nullptr) return -1;
  int files = -2;  // "." and ".."
  while (readdir(folder) != nullptr) ++files;
  closedir(folder);
  return files;
}

FaultTest::FaultTest() : spinner_(2), reaction_(node_, "probe/reaction"), diagnostics_(node_) {
  spinner_.start();
}

void FaultTest::TearDown() {
  hand_.reset();
  const long seen = reaction_.count();
  EXPECT_TRUE(waitFor([&] { return reaction_.count() > seen; })) << "the node died";
  expectSound();
}

void FaultTest::press() {
  ASSERT_TRUE(waitFor([this] { return reaction_.count() > 0; })) << "the node does not run";
  hand_ = std::make_unique<TestDevice>(node_, kAbove);
  ASSERT_TRUE(recovers()) << "nothing felt before any fault";
}

bool FaultTest::recovers() {
  // A press starts with the probe clear of the cloth. The time that the solver needs to see this
  // depends on the machine, so the hand tries again.
  return waitFor([this] {
    hand_->moveTo(kAbove);
    waitFor([this] { return hand_->arrived(); });
    sleepUntil(steadyNow() + 0.15);
    hand_->moveTo(kPressed);
    return waitFor([this] { return hand_->arrived() && reaction_.force().z() > kFelt; }, kDownAndUp);
  });
}

bool FaultTest::feels() const {
  return waitFor([this] { return reaction_.force().z() > kFelt; });
}

bool FaultTest::reaches(const std::string& key, double value) const {
  return waitFor([&] { return count(key) >= value; });
}

void FaultTest::freshDiagnostics() const {
  const long seen = diagnostics_.count();
  ASSERT_TRUE(waitFor([&] { return diagnostics_.count() > seen + 1; }));
}

WrenchFindings FaultTest::expectSound() {
  const WrenchFindings found = examine(reaction_.all(), HapticOptions());
  EXPECT_GT(found.heard, 0);
  EXPECT_EQ(found.not_finite, 0);
  EXPECT_EQ(found.too_strong, 0) << "up to " << found.strongest << " N";
  EXPECT_EQ(found.too_fast, 0) << "up to " << found.fastest << " N a tick";
  EXPECT_EQ(found.too_early, 0) << "a node must begin with zero";
  RecordProperty("wrenches", static_cast<int>(found.heard));
  RecordProperty("wrenches_lost", static_cast<int>(found.lost));
  RecordProperty("strongest_N", std::to_string(found.strongest));
  RecordProperty("fastest_N_per_tick", std::to_string(found.fastest));
  return found;
}

}  // namespace haptic_cloth
