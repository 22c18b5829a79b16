/// A device at 1 kHz that measures how fast and how regularly its poses are answered, for
/// bench/latency. It follows the path of the node's first probe after the cloth has hung for ~hang
/// simulated seconds. It measures for ~seconds, beginning at the second row of the path. With
/// ~nodelet the node runs in this process as a nodelet. A wrench has the stamp of the pose it
/// answers. All times are from one steady clock. A run that is interrupted writes nothing.
#include <diagnostic_msgs/DiagnosticArray.h>
#include <geometry_msgs/PoseStamped.h>
#include <geometry_msgs/WrenchStamped.h>
#include <nodelet/loader.h>
#include <ros/callback_queue.h>
#include <ros/ros.h>

#include <algorithm>
#include <atomic>
#include <cstdio>
#include <map>
#include <memory>
#include <nlohmann/json.hpp>
#include <thread>
#include <vector>

#include "haptic_cloth/error.h"
#include "ros/node/conversions.h"
#include "ros/node/real_time.h"
#include "ros/node/steady_clock.h"
#include "ros/node/topics.h"
#include "ros/programs/parameters.h"
#include "ros/programs/program.h"
#include "state/new_file.h"

namespace {

namespace topics = haptic_cloth::topics;
using haptic_cloth::steadyNow;
using haptic_cloth::Vec3;

constexpr double kPeriod = 1e-3;  ///< period of the poses [s]
/// Time for which poses and wrenches continue after the measurement [s].
constexpr double kTail = 0.2;
constexpr double kPatience = 60.0;   ///< longest wait for the node [s]
constexpr double kGoodRate = 950.0;  ///< a second with fewer wrenches counts as missed [Hz]

struct SentPose {
  ros::Time stamp;
  double left;  ///< steady clock [s]
};

struct ReceivedWrench {
  double arrived;  ///< steady clock [s]
  long pose;       ///< index of the pose it answers; < 0: none of ours
  float force;     ///< [N]
};

double quantile(std::vector<double> values, double share) {
  if (values.empty()) return -1.0;
  std::sort(values.begin(), values.end());
  const double last = static_cast<double>(values.size() - 1);
  return values[static_cast<std::size_t>(std::ceil(share * last))];
}

/// Sends poses on its own thread, as a driver does.
class Sender {
 public:
  /// @param device driver whose poses are sent
  Sender(ros::NodeHandle& node, const std::string& frame_id, const haptic_cloth::ProbeOptions& probe,
         const haptic_cloth::DeviceOptions& device, std::size_t most)
      : frame_id_(frame_id),
        probe_(probe),
        device_(device),
        publisher_(node.advertise<geometry_msgs::PoseStamped>(topics::ofProbe(probe.name, topics::kPose),
                                                              topics::kPoseQueue)) {
    sent_.resize(most);
  }
  ~Sender() { stop(); }

  void start() {
    thread_ = std::thread([this] { run(); });
  }
  void stop() {
    stop_ = true;
    if (thread_.joinable()) thread_.join();
  }
  /// Starts the time of the path.
  void setOut() { set_out_ = true; }
  double setOutAt() const { return set_out_at_; }  ///< steady clock [s]; < 0: not yet

  long count() const { return count_.load(std::memory_order_acquire); }
  const SentPose& pose(long number) const { return sent_[static_cast<std::size_t>(number)]; }
  std::string scheduling() const { return scheduling_; }

 private:
  void run() {
    scheduling_ = haptic_cloth::requestRealTime();
    double due = steadyNow() + kPeriod;
    while (!stop_ && count() < static_cast<long>(sent_.size())) {
      haptic_cloth::sleepUntil(due);
      due = std::max(due + kPeriod, steadyNow());
      if (set_out_ && set_out_at_ < 0.0) set_out_at_ = steadyNow();
      const double time = set_out_at_ < 0.0 ? 0.0 : steadyNow() - set_out_at_;
      // A new message each time, because within one process it is shared, not copied.
      auto message = boost::make_shared<geometry_msgs::PoseStamped>();
      message->pose = haptic_cloth::toPose(
          poseForDriver(device_, {haptic_cloth::pathPosition(probe_.path, time), probe_.orientation}));
      message->header.frame_id = frame_id_;
      message->header.stamp = ros::Time::now();
      const long number = count();
      sent_[static_cast<std::size_t>(number)] = {message->header.stamp, steadyNow()};
      count_.store(number + 1, std::memory_order_release);
      publisher_.publish(message);
    }
  }

  std::string frame_id_, scheduling_;
  haptic_cloth::ProbeOptions probe_;
  haptic_cloth::DeviceOptions device_;
  ros::Publisher publisher_;
  std::vector<SentPose> sent_;
  std::atomic<long> count_{0};
  std::atomic<bool> stop_{false}, set_out_{false};
  std::atomic<double> set_out_at_{-1.0};
  std::thread thread_;
};

/// Records every wrench on its own thread.
class Receiver {
 public:
  Receiver(ros::NodeHandle node, const std::string& topic, const Sender& sender, std::size_t most)
      : sender_(sender) {
    received_.reserve(most);
    node.setCallbackQueue(&queue_);
    subscriber_ = node.subscribe<geometry_msgs::WrenchStamped>(
        topic, 1000, [this](const geometry_msgs::WrenchStamped::ConstPtr& wrench) { accept(*wrench); },
        ros::VoidConstPtr(), ros::TransportHints().tcpNoDelay());
    thread_ = std::thread([this] {
      haptic_cloth::requestRealTime();
      while (!stop_) queue_.callAvailable(ros::WallDuration(0.01));
    });
  }
  ~Receiver() { stop(); }
  void stop() {
    stop_ = true;
    if (thread_.joinable()) thread_.join();
    subscriber_.shutdown();
  }
  bool heard() const { return heard_; }
  /// Call it only after stop().
  const std::vector<ReceivedWrench>& wrenches() const { return received_; }

 private:
  void accept(const geometry_msgs::WrenchStamped& wrench) {
    const double now = steadyNow();
    heard_ = true;
    if (received_.size() == received_.capacity()) return;
    // Wrenches answer poses in the order in which the poses were sent.
    const long sent = sender_.count();
    while (next_ < sent && sender_.pose(next_).stamp < wrench.header.stamp) ++next_;
    const bool ours = next_ < sent && sender_.pose(next_).stamp == wrench.header.stamp;
    const auto& force = wrench.wrench.force;
    received_.push_back({now, ours ? next_ : -1, static_cast<float>(Vec3(force.x, force.y, force.z).norm())});
  }

  const Sender& sender_;
  ros::CallbackQueue queue_;
  ros::Subscriber subscriber_;
  std::vector<ReceivedWrench> received_;
  long next_ = 0;  ///< index of the oldest pose that may still be answered
  std::atomic<bool> stop_{false}, heard_{false};
  std::thread thread_;
};

/// Newest diagnostics of the node.
class Diagnostics {
 public:
  explicit Diagnostics(ros::NodeHandle& node) {
    subscriber_ = node.subscribe<diagnostic_msgs::DiagnosticArray>(
        topics::kDiagnostics, topics::kDiagnosticsQueue,
        [this](const diagnostic_msgs::DiagnosticArray::ConstPtr& array) {
          for (const auto& status : array->status) {
            const std::string part = status.name.substr(
                std::min(status.name.size(), status.name.find(": ") + 2));  // after the node's name
            for (const auto& entry : status.values) values_[part + ": " + entry.key] = entry.value;
          }
        });
  }
  std::string text(const std::string& key) const {
    const auto entry = values_.find(key);
    return entry == values_.end() ? "" : entry->second;
  }
  double number(const std::string& key) const {
    const std::string value = text(key);
    return value.empty() ? -1.0 : std::strtod(value.c_str(), nullptr);
  }

 private:
  ros::Subscriber subscriber_;
  std::map<std::string, std::string> values_;
};

/// Handles all other messages until `condition` holds. @return whether it holds
template <class Condition>
bool spinUntil(const Condition& condition, double seconds) {
  const double give_up = steadyNow() + seconds;
  while (ros::ok() && !condition() && steadyNow() < give_up)
    ros::getGlobalCallbackQueue()->callAvailable(ros::WallDuration(0.02));
  return condition();
}

/// Evaluates latency, age, rate and gaps from `begin` for `seconds`.
nlohmann::json evaluate(const Sender& sender, const std::vector<ReceivedWrench>& wrenches, double begin,
                        int seconds) {
  const double end = begin + seconds;
  std::vector<double> latencies, ages;
  std::vector<int> in_second(static_cast<std::size_t>(seconds), 0);
  double longest_gap = 0.0, last = begin, force = 0.0;
  long answered = -1, poses = 0;
  for (const ReceivedWrench& wrench : wrenches) {
    const bool first = wrench.pose > answered;
    if (first) answered = wrench.pose;
    // A pose counts by the time when it left, so late answers are included.
    if (wrench.pose >= 0) {
      const double left = sender.pose(wrench.pose).left;
      if (first && left >= begin && left < end) latencies.push_back(wrench.arrived - left);
    }
    if (wrench.arrived < begin || wrench.arrived >= end) continue;
    if (wrench.pose >= 0) ages.push_back(wrench.arrived - sender.pose(wrench.pose).left);
    ++in_second[static_cast<std::size_t>(wrench.arrived - begin)];
    longest_gap = std::max(longest_gap, wrench.arrived - last);
    last = wrench.arrived;
    force += wrench.force;
  }
  longest_gap = std::max(longest_gap, end - last);
  for (long k = 0; k < sender.count(); ++k) {
    if (sender.pose(k).left >= begin && sender.pose(k).left < end) ++poses;
  }
  int count = 0;
  for (const int each : in_second) count += each;
  const auto missed = std::count_if(in_second.begin(), in_second.end(), [](int n) { return n < kGoodRate; });
  return {{"seconds", seconds},
          {"poses", poses},
          {"wrenches", count},
          {"latency_p50_ms", 1e3 * quantile(latencies, 0.5)},
          {"latency_p99_ms", 1e3 * quantile(latencies, 0.99)},
          {"latency_max_ms", 1e3 * quantile(latencies, 1.0)},
          {"age_p50_ms", 1e3 * quantile(ages, 0.5)},
          {"age_p99_ms", 1e3 * quantile(ages, 0.99)},
          {"age_max_ms", 1e3 * quantile(ages, 1.0)},
          {"rate_hz", static_cast<double>(count) / seconds},
          {"slowest_second_hz", *std::min_element(in_second.begin(), in_second.end())},
          {"missed_seconds", missed},
          {"longest_gap_ms", 1e3 * longest_gap},
          {"answered_percent", 100.0 * static_cast<double>(latencies.size()) / std::max(1L, poses)},
          {"force_mean_n", force / std::max(1, count)}};
}

/// Writes the result; to standard output if it would be lost. @param path empty: there alone
void write(const std::string& result, const std::string& path) {
  if (path.empty()) {
    std::fputs(result.c_str(), stdout);
    return;
  }
  try {
    haptic_cloth::NewFiles files;
    files.add(path).stream() << result;
    files.publish();
  } catch (const haptic_cloth::OutputError&) {
    std::fputs(result.c_str(), stdout);
    throw;
  }
}

int run(int argc, char** argv) {
  ros::init(argc, argv, "latency_probe");
  haptic_cloth::endOnSigterm();
  ros::NodeHandle node, private_node("~");
  const auto options = haptic_cloth::ownOptions<haptic_cloth::LatencyProbeOptions>(private_node);
  const haptic_cloth::NodeOptions served = haptic_cloth::optionsOf(node, options.node);
  const haptic_cloth::ProbeOptions& probe = served.scene.probes[0];
  if (probe.path.size() < 2)
    throw haptic_cloth::InputError(options.node, "probe.path", "", "must have two rows");
  if (!options.out.empty()) haptic_cloth::checkNewFile(options.out);

  std::unique_ptr<nodelet::Loader> loader;
  if (options.nodelet) {
    loader = std::make_unique<nodelet::Loader>(false);
    if (!loader->load(options.node, "haptic_cloth/HapticCloth", {}, {}))
      throw std::runtime_error("the nodelet does not load");
  }
  const double approach = probe.path[1].time;
  const auto most = static_cast<std::size_t>((10.0 * kPatience + approach + options.seconds) / kPeriod);
  Sender sender(node, served.frame_id, probe, served.probes[0].device, most);
  Diagnostics diagnostics(node);
  Receiver receiver(node, topics::ofProbe(probe.name, topics::kReaction), sender, most);
  sender.start();
  if (!spinUntil([&] { return receiver.heard(); }, kPatience)) throw std::runtime_error("no wrench comes");
  const bool hangs = spinUntil(
      [&] { return diagnostics.number("solver: simulated time [s]") >= options.hang; }, 4.0 * kPatience);
  if (!hangs) throw std::runtime_error("the cloth does not hang");
  sender.setOut();
  if (!spinUntil([&] { return sender.setOutAt() >= 0.0; }, kPatience))
    throw std::runtime_error("no poses go out");
  const double begin = sender.setOutAt() + approach;
  const double end = begin + options.seconds + kTail;
  if (!spinUntil([&] { return steadyNow() > end; }, end + 1.0 - steadyNow()))
    throw std::runtime_error("interrupted: there is no result");
  sender.stop();
  receiver.stop();

  nlohmann::json result = evaluate(sender, receiver.wrenches(), begin, options.seconds);
  result["real_time_factor"] = diagnostics.number("solver: real-time factor");
  result["active_particles"] = diagnostics.number("solver: active particles");
  result["processor"] = diagnostics.text("solver: processor");
  result["simd"] = diagnostics.text("solver: instruction set");
  result["scheduling"] = diagnostics.text("haptic thread: scheduling");
  result["late_p50_us"] = diagnostics.number("haptic thread: late p50 [us]");
  result["late_p99_us"] = diagnostics.number("haptic thread: late p99 [us]");
  result["probe_scheduling"] = sender.scheduling();
  write(result.dump(1) + '\n', options.out);
  return 0;
}

}  // namespace

int main(int argc, char** argv) { return haptic_cloth::runProgram("latency_probe", run, argc, argv); }
