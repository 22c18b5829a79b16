/// A button of the device as a grasp: closed while it is held. Exit status: 0 if asked to end, 2 for
/// bad parameters, 1 for any other error. It ends with an open grasp.
#include <ros/callback_queue.h>
#include <ros/ros.h>
#include <std_msgs/Bool.h>

#include <atomic>
#include <optional>

#include "ros/input/driver_messages.h"
#include "ros/node/shutdown.h"
#include "ros/node/steady_clock.h"
#include "ros/node/topics.h"
#include "ros/programs/parameters.h"
#include "ros/programs/program.h"

namespace {

namespace topics = haptic_cloth::topics;

constexpr double kLook = 0.01;      ///< longest wait for a message between two looks at the driver [s]
constexpr double kSayPeriod = 5.0;  ///< interval between two warnings of the same kind [s]
constexpr double kFlush = 0.05;     ///< time for the last message to leave the process [s]
constexpr double kEnd = 5.0;        ///< longest time for signing off at the master [s]

/// device/button (a type of driver_messages.h) → probe/grasp.
class GraspButton {
 public:
  GraspButton(ros::NodeHandle& node, int number)
      : number_(static_cast<std::size_t>(number)),
        grasp_(node.advertise<std_msgs::Bool>(topics::kGrasp, topics::kGraspQueue)),
        buttons_(node.subscribe(topics::kDeviceButton, topics::kDeviceButtonQueue, &GraspButton::accept, this,
                                ros::TransportHints().tcpNoDelay())) {}

  /// Opens the grasp if nobody is left who could let the button go.
  void look() {
    if (buttons_.getNumPublishers() == 0) close(false);
  }

  void close(bool closed) {
    // A grasp may be closed already, by a button that ended before it was let go.
    if (closed == closed_ || (!closed_ && grasp_.getNumSubscribers() == 0)) return;
    closed_ = closed;
    std_msgs::Bool message;
    message.data = closed;
    grasp_.publish(message);
  }

 private:
  void accept(const topic_tools::ShapeShifter::ConstPtr& message) {
    const haptic_cloth::ButtonReader reader = haptic_cloth::findButtonReader(message->getMD5Sum());
    if (!reader) {
      ROS_ERROR_STREAM_THROTTLE(kSayPeriod, message->getDataType() << ": no known type of buttons");
      return;
    }
    const auto held = reader(*message);
    if (!held) {
      ROS_WARN_STREAM_THROTTLE(kSayPeriod, "a message of " << message->getDataType() << " is too short");
    } else if (held->size() <= number_) {
      ROS_ERROR_STREAM_THROTTLE(kSayPeriod, "no button ~number = " << number_ << ": "
                                                                   << message->getDataType() << " has "
                                                                   << held->size());
    } else {
      close((*held)[number_]);
    }
  }

  std::size_t number_;
  std::optional<bool> closed_;  ///< as last published; unknown until somebody hears it
  ros::Publisher grasp_;
  ros::Subscriber buttons_;
};

int run(int argc, char** argv) {
  ros::init(argc, argv, "grasp_button", ros::init_options::NoSigintHandler);
  const haptic_cloth::Signals signals;
  std::atomic<bool> asked{false};
  haptic_cloth::answerShutdownCall(asked);
  if (!haptic_cloth::waitForMaster(signals)) return 0;
  ros::NodeHandle node, private_node("~");
  const auto options = haptic_cloth::ownOptions<haptic_cloth::GraspButtonOptions>(private_node);
  GraspButton button(node, options.number);
  while (!asked && ros::ok() && !signals.wait(0)) {
    ros::getGlobalCallbackQueue()->callAvailable(ros::WallDuration(kLook));
    button.look();
  }
  haptic_cloth::endWithin(kEnd);
  button.close(false);
  haptic_cloth::sleepUntil(haptic_cloth::steadyNow() + kFlush);
  return 0;
}

}  // namespace

int main(int argc, char** argv) { return haptic_cloth::runProgram("grasp_button", run, argc, argv); }
