#include "ros/input/device_adapter.h"

#include <ros/console.h>
#include <ros/master.h>
#include <ros/this_node.h>
#include <xmlrpcpp/XmlRpcException.h>

#include <algorithm>

#include "haptic_cloth/error.h"
#include "haptic_cloth/haptics.h"
#include "ros/node/conversions.h"
#include "ros/node/steady_clock.h"
#include "ros/node/topics.h"

namespace haptic_cloth {
namespace {

constexpr double kAskPeriod = 0.5;    ///< interval between two questions to the master [s]
constexpr double kSayPeriod = 5.0;    ///< interval between two warnings of the same kind [s]
constexpr int kZeros = 20;            ///< number of zeros sent at the end
constexpr double kZeroPeriod = 2e-3;  ///< interval between them [s]
constexpr double kFlush = 0.05;       ///< time for the last message to leave the process [s]

}  // namespace

std::vector<OptionGroup> groupsOf(AdapterOptions& adapter) {
  const std::string known = "no longer exists: the adapter knows the types in docs/guide/devices.md";
  return {
      {"", "", {}},
      {"pose/",
       "device/pose",
       {{"frame_id", field(adapter.pose_frame), kNoRange, "",
         "frame of the poses; empty: that of the driver's header"}},
       {{"field", known}}},
      {"force/",
       "device/force",
       {{"type", field(adapter.force_type), kNoRange, "",
         "package/Name; empty: the type that the driver subscribes to"},
        {"timeout", field(adapter.timeout), kPositive, "s", "zeros go out after this silence of the node"},
        {"soft_start", field(adapter.soft_start), kNotNegative, "s",
         "rise of the force after zeros of the adapter's own"}},
       {{"field", known}, {"definition", known}}}};
}

std::optional<std::string> typeOnMaster(const std::string& topic) {
  XmlRpc::XmlRpcValue request, response, types;
  request[0] = ros::this_node::getName();
  if (!ros::master::execute("getTopicTypes", request, response, types, false)) return std::nullopt;
  try {
    for (int k = 0; k < types.size(); ++k) {
      if (static_cast<std::string>(types[k][0]) != topic) continue;
      const auto type = static_cast<std::string>(types[k][1]);
      if (type != "*") return type;
    }
  } catch (const XmlRpc::XmlRpcException&) {  // an answer of another form names no type
  }
  return std::nullopt;
}

PoseAdapter::PoseAdapter(ros::NodeHandle& node, const AdapterOptions& options)
    : options_(options),
      node_(node),
      pose_(node.advertise<geometry_msgs::PoseStamped>(topics::kPose, topics::kPoseQueue)),
      gate_(0.0, HapticOptions().pose_timeout) {
  subscribe();
}

void PoseAdapter::subscribe() {
  subscriber_.shutdown();
  subscriber_ = node_.subscribe(topics::kDevicePose, topics::kPoseQueue, &PoseAdapter::accept, this,
                                ros::TransportHints().tcpNoDelay());
}

void PoseAdapter::look() {
  {
    const std::lock_guard<std::mutex> lock(mutex_);
    if (type_.empty() || steadyNow() - std::max(asked_, heard_) < kAskPeriod) return;
  }
  asked_ = steadyNow();
  const std::optional<std::string> type = typeOnMaster(node_.resolveName(topics::kDevicePose));
  {
    const std::lock_guard<std::mutex> lock(mutex_);
    if (!type || *type == type_) return;
    type_ = *type;
  }
  ROS_INFO_STREAM("a driver publishes positions as " << *type << " now");
  subscribe();
}

void PoseAdapter::accept(const ros::MessageEvent<topic_tools::ShapeShifter const>& event) {
  const std::string& sender = event.getPublisherName();
  const std_msgs::Header no_stamp;  // the node judges stamps
  const double received = steadyNow();
  if (gate_.judge(no_stamp, true, sender, ros::Time(), received) == PoseVerdict::OtherSender) {
    ROS_WARN_STREAM_THROTTLE(kSayPeriod, "positions from " << sender << " are dropped as long as "
                                                           << gate_.sender() << " sends, too");
    return;
  }
  gate_.take(no_stamp, sender, received);
  const topic_tools::ShapeShifter::ConstPtr message = event.getConstMessage();
  if (message->getMD5Sum() != md5sum_) {
    md5sum_ = message->getMD5Sum();
    {
      const std::lock_guard<std::mutex> lock(mutex_);
      type_ = message->getDataType();
    }
    reader_ = findPositionReader(md5sum_);
    if (reader_) {
      ROS_INFO_STREAM("positions from " << message->getDataType());
    } else {
      ROS_ERROR_STREAM(message->getDataType() << ": no known type of position");
    }
  }
  if (!reader_) return;
  const std::optional<DriverPosition> found = reader_(*message);
  if (!found) {
    ROS_WARN_STREAM_THROTTLE(kSayPeriod, "a message of " << message->getDataType() << " is too short");
    return;
  }
  {
    const std::lock_guard<std::mutex> lock(mutex_);
    heard_ = received;
  }
  geometry_msgs::PoseStamped pose;
  pose.header.stamp = found->header.stamp.isZero() ? ros::Time::now() : found->header.stamp;
  pose.header.frame_id = options_.pose_frame.empty() ? found->header.frame_id : options_.pose_frame;
  pose.pose = toPose(found->position);
  pose_.publish(pose);
}

ForceAdapter::ForceAdapter(ros::NodeHandle& node, const AdapterOptions& options)
    : options_(options), node_(node) {
  if (!options.force_type.empty()) advertise(options.force_type);
  subscriber_ = node_.subscribe<geometry_msgs::WrenchStamped>(
      topics::kReaction, topics::kReactionQueue,
      [this](const geometry_msgs::WrenchStamped::ConstPtr& wrench) { accept(*wrench); }, ros::VoidConstPtr(),
      ros::TransportHints().tcpNoDelay());
}

void ForceAdapter::look() {
  const std::lock_guard<std::mutex> lock(mutex_);
  if (!type_) learn();
  if (steadyNow() - received_ > options_.timeout) sendZero({ros::Time::now(), ""});
}

void ForceAdapter::end() {
  for (int i = 0; i < kZeros; ++i) {
    {
      const std::lock_guard<std::mutex> lock(mutex_);
      ended_ = true;
      sendZero({ros::Time::now(), ""});
    }
    sleepUntil(steadyNow() + kZeroPeriod);
  }
  sleepUntil(steadyNow() + kFlush);
}

void ForceAdapter::accept(const geometry_msgs::WrenchStamped& wrench) {
  const std::lock_guard<std::mutex> lock(mutex_);
  if (ended_) return;
  const MessageHeader header{wrench.header.stamp, wrench.header.frame_id};
  const auto& given = wrench.wrench.force;
  const Vec3 force(given.x, given.y, given.z);
  if (!force.allFinite()) {
    ROS_WARN_THROTTLE(kSayPeriod, "a force is not finite; zero is sent instead");
    return sendZero(header);
  }
  received_ = steadyNow();
  const bool reaches = type_ && force_.getNumSubscribers() > 0;
  if (zero_ || !reaches) rises_from_ = received_;
  zero_ = false;
  const double risen = received_ - rises_from_;
  send(risen < options_.soft_start ? Vec3(risen / options_.soft_start * force) : force, header);
}

/// Sends a zero of the adapter's own, after which the force rises softly.
void ForceAdapter::sendZero(const MessageHeader& header) {
  zero_ = true;
  send(Vec3::Zero(), header);
}

void ForceAdapter::learn() {
  if (steadyNow() - asked_ < kAskPeriod) return;
  asked_ = steadyNow();
  const std::optional<std::string> name = typeOnMaster(node_.resolveName(topics::kDeviceForce));
  if (!name || *name == refused_) return;
  try {
    advertise(*name);
  } catch (const InputError& error) {
    refused_ = *name;
    ROS_ERROR_STREAM(
        error.what() << "; the ROS master keeps this type of the topic until a program publishes "
                        "it: for another one set ~force/type");
  }
}

void ForceAdapter::advertise(const std::string& datatype) {
  const ForceType* type = findForceType(datatype);
  if (!type) throw InputError("force/type", datatype, "", "must be a type of force that the adapter knows");
  message_.morph(type->md5sum, datatype, type->definition, "");
  force_ = message_.advertise(node_, topics::kDeviceForce, topics::kReactionQueue);
  type_ = type;
  ROS_INFO_STREAM("forces as " << datatype);
}

void ForceAdapter::send(const Vec3& force, const MessageHeader& header) {
  if (!type_) return;
  std::vector<unsigned char> bytes = type_->write(force, header);
  ros::serialization::IStream stream(bytes.data(), static_cast<std::uint32_t>(bytes.size()));
  message_.read(stream);
  force_.publish(message_);
}

}  // namespace haptic_cloth
