/// Parts that the node tests share: a device, listeners that wait for conditions, and separate
/// processes.
#pragma once

#include <diagnostic_msgs/DiagnosticArray.h>
#include <geometry_msgs/PoseStamped.h>
#include <geometry_msgs/WrenchStamped.h>
#include <ros/ros.h>
#include <sys/types.h>

#include <atomic>
#include <functional>
#include <map>
#include <memory>
#include <mutex>
#include <set>
#include <string>
#include <thread>
#include <vector>

#include "haptic_cloth/types.h"

namespace haptic_cloth {

/// Longest wait for a condition, long enough for a busy machine [s].
constexpr double kPatience = 30.0;

/// @return whether `condition` became true within `seconds`
bool waitFor(const std::function<bool()>& condition, double seconds = kPatience);

/// Directory of this program, which also holds the programs under test.
std::string programDirectory();

/// A device at 500 Hz that moves towards its target at 0.1 m/s.
class TestDevice {
 public:
  TestDevice(ros::NodeHandle& node, const Vec3& start, const std::string& topic = "probe/pose");
  ~TestDevice();
  void moveTo(const Vec3& target);
  /// Sets the orientation from the next pose on.
  void turn(const Quat& orientation);
  bool arrived() const { return arrived_; }
  /// Stops sending poses until resume().
  void silence() { silent_ = true; }
  void resume() { silent_ = false; }

 private:
  void run();
  ros::Publisher publisher_;
  std::mutex mutex_;
  Vec3 position_, target_;
  Quat orientation_ = Quat::Identity();
  std::atomic<bool> silent_{false}, arrived_{false}, stop_{false};
  std::thread thread_;
};

/// Records the messages on probe/reaction.
class ReactionListener {
 public:
  ReactionListener(ros::NodeHandle& node, const std::string& topic);
  long count() const { return count_; }
  bool finite() const { return finite_; }
  geometry_msgs::WrenchStamped last() const;
  Vec3 force() const;
  Vec3 torque() const;

 private:
  mutable std::mutex mutex_;
  geometry_msgs::WrenchStamped last_;
  std::atomic<long> count_{0};
  std::atomic<bool> finite_{true};
  ros::Subscriber subscriber_;  ///< last member: its callback uses all members above
};

/// Keeps the newest diagnostics of the node.
class DiagnosticsListener {
 public:
  explicit DiagnosticsListener(ros::NodeHandle& node);
  /// Value in the diagnostics, "" until it is received. @param part "solver", "haptic thread",
  /// "display" or the name of a probe
  std::string value(const std::string& part, const std::string& key) const;
  double number(const std::string& part, const std::string& key) const;
  /// Whether a status with this name, which includes the node's, was ever received.
  bool heard(const std::string& name) const;
  long count() const { return count_; }

 private:
  mutable std::mutex mutex_;
  std::map<std::string, std::string> values_;
  std::set<std::string> names_;
  std::atomic<long> count_{0};
  ros::Subscriber subscriber_;  ///< last member: its callback uses all members above
};

/// A child process whose standard output and error are kept.
class Process {
 public:
  /// @param environment "NAME=VALUE" in addition to that of this process
  Process(const std::vector<std::string>& command, const std::vector<std::string>& environment = {});
  ~Process();
  void signal(int number) const;
  bool running();
  /// @return exit code, 128 + signal, or -1 if it still runs after `seconds`
  int wait(double seconds = kPatience);
  std::string output() const;

 private:
  pid_t pid_ = -1;
  int code_ = -1;
  std::string output_file_;
};

/// A ROS master on its own port, which can be killed without affecting the test's master.
class OwnMaster {
 public:
  OwnMaster();
  void start();
  void kill();
  void signal(int number) const { process_->signal(number); }
  /// URI of the master, "http://…".
  std::string uri() const;
  /// @return whether the master answers and knows a node
  bool knows(const std::string& node) const { return ask("lookupNode", node); }
  bool knowsService(const std::string& service) const { return ask("lookupService", service); }

 private:
  bool ask(const std::string& method, const std::string& name) const;

  int port_;
  std::unique_ptr<Process> process_;
};

}  // namespace haptic_cloth
