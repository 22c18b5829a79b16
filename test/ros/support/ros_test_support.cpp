#include "ros/support/ros_test_support.h"

#include <fcntl.h>
#include <signal.h>
#include <stdlib.h>
#include <sys/wait.h>
#include <unistd.h>
#include <xmlrpcpp/XmlRpcClient.h>

#include <algorithm>
#include <chrono>
#include <fstream>
#include <sstream>

#include "ros/node/conversions.h"
#include "ros/node/steady_clock.h"

namespace haptic_cloth {

bool waitFor(const std::function<bool()>& condition, double seconds) {
  const double end = steadyNow() + seconds;
  while (!condition()) {
    if (steadyNow() > end) return false;
    std::this_thread::sleep_for(std::chrono::milliseconds(5));
  }
  return true;
}

std::string programDirectory() {
  char path[4096];
  const ssize_t length = readlink("/proc/self/exe", path, sizeof path);
  const std::string program(path, length > 0 ? static_cast<std::size_t>(length) : 0);
  return program.substr(0, program.rfind('/'));
}

TestDevice::TestDevice(ros::NodeHandle& node, const Vec3& start, const std::string& topic)
    : publisher_(node.advertise<geometry_msgs::PoseStamped>(topic, 1)),
      position_(start),
      target_(start),
      thread_([this] { run(); }) {}

TestDevice::~TestDevice() {
  stop_ = true;
  thread_.join();
}

void TestDevice::moveTo(const Vec3& target) {
  const std::lock_guard<std::mutex> lock(mutex_);
  target_ = target;
  arrived_ = false;
}

void TestDevice::turn(const Quat& orientation) {
  const std::lock_guard<std::mutex> lock(mutex_);
  orientation_ = orientation;
}

void TestDevice::run() {
  constexpr double kPeriod = 2e-3, kStep = 0.1 * kPeriod;
  while (!stop_) {
    sleepUntil(steadyNow() + kPeriod);
    if (silent_) continue;
    geometry_msgs::PoseStamped pose;
    {
      const std::lock_guard<std::mutex> lock(mutex_);
      const Vec3 way = target_ - position_;
      position_ = way.norm() > kStep ? Vec3(position_ + kStep * way.normalized()) : target_;
      arrived_ = position_ == target_;
      pose.pose = toPose(position_, orientation_);
    }
    pose.header.stamp = ros::Time::now();
    pose.header.frame_id = "world";
    publisher_.publish(pose);
  }
}

ReactionListener::ReactionListener(ros::NodeHandle& node, const std::string& topic) {
  subscriber_ = node.subscribe<geometry_msgs::WrenchStamped>(
      topic, 1000,
      [this](const geometry_msgs::WrenchStamped::ConstPtr& message) {
        const std::lock_guard<std::mutex> lock(mutex_);
        last_ = *message;
        const auto& [force, torque] = message->wrench;
        finite_ = finite_ && Vec3(force.x, force.y, force.z).allFinite() &&
                  Vec3(torque.x, torque.y, torque.z).allFinite();
        ++count_;
      },
      ros::VoidConstPtr(), ros::TransportHints().tcpNoDelay());
}

geometry_msgs::WrenchStamped ReactionListener::last() const {
  const std::lock_guard<std::mutex> lock(mutex_);
  return last_;
}

Vec3 ReactionListener::force() const {
  const geometry_msgs::Vector3 force = last().wrench.force;
  return {force.x, force.y, force.z};
}

Vec3 ReactionListener::torque() const {
  const geometry_msgs::Vector3 torque = last().wrench.torque;
  return {torque.x, torque.y, torque.z};
}

DiagnosticsListener::DiagnosticsListener(ros::NodeHandle& node) {
  subscriber_ = node.subscribe<diagnostic_msgs::DiagnosticArray>(
      "/diagnostics", 10, [this](const diagnostic_msgs::DiagnosticArray::ConstPtr& array) {
        const std::lock_guard<std::mutex> lock(mutex_);
        for (const auto& status : array->status) {
          names_.insert(status.name);
          const std::string part =
              status.name.substr(std::min(status.name.size(), status.name.find(": ") + 2));
          for (const auto& entry : status.values) values_[part + "/" + entry.key] = entry.value;
        }
        ++count_;
      });
}

std::string DiagnosticsListener::value(const std::string& part, const std::string& key) const {
  const std::lock_guard<std::mutex> lock(mutex_);
  const auto entry = values_.find(part + "/" + key);
  return entry == values_.end() ? "" : entry->second;
}

bool DiagnosticsListener::heard(const std::string& name) const {
  const std::lock_guard<std::mutex> lock(mutex_);
  return names_.count(name) > 0;
}

double DiagnosticsListener::number(const std::string& part, const std::string& key) const {
  const std::string text = value(part, key);
  return text.empty() ? -1.0 : std::strtod(text.c_str(), nullptr);
}

Process::Process(const std::vector<std::string>& command, const std::vector<std::string>& environment) {
  char name[] = "/tmp/haptic_cloth_test_XXXXXX";
  const int file = mkstemp(name);
  output_file_ = name;
  pid_ = fork();
  if (pid_ == 0) {
    dup2(file, STDOUT_FILENO);  // rosconsole prints warnings there
    dup2(file, STDERR_FILENO);
    for (const std::string& entry : environment) {
      const std::size_t equals = entry.find('=');
      setenv(entry.substr(0, equals).c_str(), entry.substr(equals + 1).c_str(), 1);
    }
    std::vector<char*> arguments;
    for (const std::string& word : command) arguments.push_back(const_cast<char*>(word.c_str()));
    arguments.push_back(nullptr);
    execvp(arguments[0], arguments.data());
    _exit(127);
  }
  close(file);
}

Process::~Process() {
  if (running()) {
    signal(SIGKILL);
    wait();
  }
  unlink(output_file_.c_str());
}

void Process::signal(int number) const { kill(pid_, number); }

bool Process::running() { return wait(0.0) < 0; }

int Process::wait(double seconds) {
  waitFor(
      [this] {
        int status = 0;
        if (code_ < 0 && waitpid(pid_, &status, WNOHANG) == pid_) {
          code_ = WIFEXITED(status) ? WEXITSTATUS(status) : 128 + WTERMSIG(status);
        }
        return code_ >= 0;
      },
      seconds);
  return code_;
}

std::string Process::output() const {
  std::ostringstream text;
  text << std::ifstream(output_file_).rdbuf();
  return text.str();
}

OwnMaster::OwnMaster() : port_(20000 + getpid() % 10000) { start(); }

void OwnMaster::start() {
  process_ =
      std::make_unique<Process>(std::vector<std::string>{"rosmaster", "--core", "-p", std::to_string(port_)});
}

void OwnMaster::kill() {
  process_->signal(SIGKILL);
  process_->wait();
}

std::string OwnMaster::uri() const { return "http://localhost:" + std::to_string(port_) + "/"; }

bool OwnMaster::ask(const std::string& method, const std::string& name) const {
  XmlRpc::XmlRpcClient client("localhost", port_, "/");
  XmlRpc::XmlRpcValue request, response;
  request[0] = "/test";
  request[1] = name;
  return client.execute(method.c_str(), request, response) && !client.isFault() &&
         response.getType() == XmlRpc::XmlRpcValue::TypeArray && static_cast<int>(response[0]) == 1;
}

}  // namespace haptic_cloth
