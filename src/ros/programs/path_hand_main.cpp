/// A hand that follows the scene: every probe with a path follows it and grasps at its times. Time
/// starts with a reset of the cloth, once the node subscribes to every probe. It is the cloth's
/// time: in slow motion the hand is slow as well. With ~repeat_after the paths start again.
#include <geometry_msgs/PoseStamped.h>
#include <haptic_cloth/ClothState.h>
#include <ros/ros.h>
#include <std_msgs/Bool.h>
#include <std_srvs/Empty.h>

#include <algorithm>
#include <deque>
#include <limits>

#include "haptic_cloth/error.h"
#include "ros/node/conversions.h"
#include "ros/node/steady_clock.h"
#include "ros/node/topics.h"
#include "ros/options/node_options.h"
#include "ros/programs/parameters.h"
#include "ros/programs/program.h"

namespace {

namespace topics = haptic_cloth::topics;

/// Duration of poses before the reset: the node must know the place of each probe when the cloth
/// restarts [s].
constexpr double kLead = 0.5;

/// Silence beyond `probe_timeout` before the paths start again: the probes leave the scene, so they do not
/// press on cloth on the way to their start [s].
constexpr double kSilence = 0.2;

/// A closed grasp is told again after this time, because a pause and a loaded state open it [s].
constexpr double kGraspPeriod = 0.5;

/// Estimates the time of the cloth between two state messages, at the real-time factor of the last interval.
class ClothClock {
 public:
  /// The time goes back if others reset the cloth or load a state. The hand then goes on from there.
  void hear(double cloth_time) {
    const double now = haptic_cloth::steadyNow();
    if (cloth_time < heard_) {
      *this = ClothClock();
      time_ = cloth_time;
    }
    const bool forward = cloth_time > heard_ && now > when_;
    if (when_ > 0.0 && forward) real_time_factor_ = std::min(1.0, (cloth_time - heard_) / (now - when_));
    heard_ = cloth_time;
    when_ = now;
  }
  /// Estimated time. Between two calls of hear() it never decreases, is at most 0.1 s ahead of the last
  /// message, and runs at most twice as fast as real time: a hand does not jump because messages were late.
  double read() {
    const double now = haptic_cloth::steadyNow();
    const double ahead = std::min(now - when_, kAhead);
    const double estimate = heard_ + real_time_factor_ * ahead;
    if (read_ > 0.0) time_ = std::clamp(estimate, time_, time_ + kFastest * (now - read_));
    read_ = now;
    return time_;
  }

 private:
  static constexpr double kAhead = 0.1;    ///< [s]
  static constexpr double kFastest = 2.0;  ///< [-]
  double heard_ = 0.0, when_ = 0.0, real_time_factor_ = 0.0, time_ = 0.0;
  double read_ = 0.0;  ///< when read() was called last [s]
};

/// Separates states of the restarted cloth from states sent before its reset. It uses the cloth's
/// time, because stamps may be from a clock that stands still or runs in a loop.
class FirstNews {
 public:
  void hearBefore(double cloth_time) { before_ = cloth_time; }
  bool isNew(double cloth_time) {
    begun_ = begun_ || cloth_time < before_ || ++doubtful_ > kUnderWay;
    return begun_;
  }

 private:
  /// largest number of messages on the way: one in each of the two queues
  static constexpr int kUnderWay = 2;
  double before_ = std::numeric_limits<double>::infinity();
  int doubtful_ = 0;
  bool begun_ = false;
};

/// One probe on its path.
class PathProbe {
 public:
  PathProbe(const haptic_cloth::NodeOptions& options, std::size_t number, ros::NodeHandle& node)
      : frame_id_(options.frame_id),
        probe_(options.scene.probes[number]),
        device_(options.probes[number].device),
        pose_(node.advertise<geometry_msgs::PoseStamped>(topics::ofProbe(probe_.name, topics::kPose),
                                                         topics::kPoseQueue)),
        grasp_(node.advertise<std_msgs::Bool>(topics::ofProbe(probe_.name, topics::kGrasp),
                                              topics::kGraspQueue)) {}

  /// @param time on the path [s]; 0 until the cloth has made a step after its reset. Until then the
  /// probe is open: the reset opens every grasp, and the node refuses to grasp before the step
  void step(double time) {
    geometry_msgs::PoseStamped message;
    message.header.stamp = ros::Time::now();
    message.header.frame_id = frame_id_;
    message.pose =
        haptic_cloth::toPose(poseForDriver(device_, {pathPosition(probe_.path, time), probe_.orientation}));
    pose_.publish(message);
    std_msgs::Bool closed;
    closed.data = time > 0.0 && std::any_of(probe_.grasp.begin(), probe_.grasp.end(), [&](const auto& times) {
                    return times[0] <= time && time < times[1];
                  });
    const double now = haptic_cloth::steadyNow();
    if (closed.data == closed_ && !(closed_ && now > told_ + kGraspPeriod)) return;
    grasp_.publish(closed);
    closed_ = closed.data;
    told_ = now;
  }

  bool isHeard() const { return pose_.getNumSubscribers() > 0; }
  double end() const { return probe_.path.back().time; }  ///< of the path [s]

 private:
  std::string frame_id_;
  haptic_cloth::ProbeOptions probe_;
  haptic_cloth::DeviceOptions device_;
  ros::Publisher pose_, grasp_;
  bool closed_ = false;
  double told_ = 0.0;  ///< when the node was told so [s]
};

int run(int argc, char** argv) {
  ros::init(argc, argv, "path_hand");
  haptic_cloth::endOnSigterm();
  ros::NodeHandle node, private_node("~");
  const auto path = haptic_cloth::ownOptions<haptic_cloth::PathHandOptions>(private_node);
  const std::string served = node.resolveName(path.node);
  const haptic_cloth::NodeOptions options = haptic_cloth::optionsOf(node, served);

  std::deque<PathProbe> probes;
  for (std::size_t k = 0; k < options.scene.probes.size(); ++k) {
    if (!options.scene.probes[k].path.empty()) probes.emplace_back(options, k, node);
  }
  if (probes.empty())
    throw haptic_cloth::InputError(served + " (parameters)", "", "", "no probe of the scene has a path");
  double end = 0.0;  // of all paths
  for (const PathProbe& probe : probes) end = std::max(end, probe.end());
  const double period = 1.0 / path.rate;
  ClothClock clock;
  FirstNews news;
  bool started = false;
  const ros::Subscriber state = node.subscribe<haptic_cloth::ClothState>(
      topics::kState, topics::kStateQueue, [&](const haptic_cloth::ClothState::ConstPtr& message) {
        if (!started) news.hearBefore(message->time);
        if (started && news.isNew(message->time)) clock.hear(message->time);
      });
  double lead = kLead, due = haptic_cloth::steadyNow();
  while (ros::ok()) {
    haptic_cloth::sleepUntil(due += period);
    const bool heard =
        std::all_of(probes.begin(), probes.end(), [](const PathProbe& probe) { return probe.isHeard(); });
    if (heard) lead -= period;
    if (lead < 0.0 && !started) {
      std_srvs::Empty empty;
      started = ros::service::call(served + "/" + topics::kReset, empty);
      due = haptic_cloth::steadyNow();
    }
    ros::spinOnce();
    const double time = started ? clock.read() : 0.0;
    if (lead <= kLead) {
      for (PathProbe& probe : probes) probe.step(time);
    }
    if (path.repeat_after > 0.0 && time > end + path.repeat_after) {
      started = false;
      lead = kLead + options.haptics.probe_timeout + kSilence;
      clock = ClothClock();
      news = FirstNews();
    }
  }
  return 0;
}

}  // namespace

int main(int argc, char** argv) { return haptic_cloth::runProgram("path_hand", run, argc, argv); }
