/// A foreign driver through adapter and node and back: signs, scales, axes, and zeros whenever
/// something stalls. The driver sends its position as Vector3 in millimetres and takes
/// omni_msgs/OmniFeedback. That package is not installed, so its MD5 sum, as computed by genmsg,
/// stands here.
#include <geometry_msgs/Twist.h>
#include <geometry_msgs/Vector3.h>
#include <geometry_msgs/Wrench.h>
#include <gtest/gtest.h>
#include <ros/ros.h>
#include <sensor_msgs/Joy.h>
#include <signal.h>
#include <std_msgs/Bool.h>
#include <std_msgs/Int8MultiArray.h>
#include <std_srvs/SetBool.h>
#include <topic_tools/shape_shifter.h>

#include <cmath>
#include <cstring>
#include <limits>
#include <memory>
#include <thread>

#include "ros/node/conversions.h"
#include "ros/node/steady_clock.h"
#include "ros/support/ros_test_support.h"

namespace haptic_cloth::device_test {
namespace {

// Values of test/ros/input/device.test and defaults of the scene.
constexpr double kStiffness = 400.0, kForceScale = 0.5, kMetresPerUnit = 0.002, kHeight = 0.025;
/// Positions in the driver's axes, y up: free above the cloth, and pressed 10 mm into it.
const Vec3 kAbove(0.0, 50.0, 0.0), kPressed(0.0, 37.5, 0.0);

/// A driver like those of OpenHaptics devices, without the device.
class FakeDriver {
 public:
  explicit FakeDriver(ros::NodeHandle& node)
      : position_(kAbove),
        target_(kAbove),
        publisher_(node.advertise<geometry_msgs::Vector3>("driver/position", 1)),
        thread_([this] { run(); }) {
    ros::SubscribeOptions options;
    options.topic = "driver/force";
    options.queue_size = 1000;
    options.datatype = "omni_msgs/OmniFeedback";
    options.md5sum = "e9083ac4fd95494e94fbb0c0f90b6c00";
    options.helper =
        boost::make_shared<ros::SubscriptionCallbackHelperT<const topic_tools::ShapeShifter::ConstPtr&>>(
            [this](const topic_tools::ShapeShifter::ConstPtr& message) { accept(*message); });
    subscriber_ = node.subscribe(options);
  }
  ~FakeDriver() {
    subscriber_.shutdown();
    stop_ = true;
    thread_.join();
  }

  void moveTo(const Vec3& target) {
    const std::lock_guard<std::mutex> lock(mutex_);
    target_ = target;
  }
  void silence(bool silent) { silent_ = silent; }
  Vec3 force() const {
    const std::lock_guard<std::mutex> lock(mutex_);
    return force_;
  }
  long count() const { return count_; }
  bool wellFormed() const { return well_formed_; }

 private:
  void run() {
    constexpr double kPeriod = 2e-3, kStep = 50.0 * kPeriod;  // mm/s: 0.1 m/s in the cloth
    while (!stop_) {
      sleepUntil(steadyNow() + kPeriod);
      if (silent_) continue;
      geometry_msgs::Vector3 message;
      {
        const std::lock_guard<std::mutex> lock(mutex_);
        const Vec3 way = target_ - position_;
        const bool near = way.norm() <= kStep, far = way.norm() > 1e3;
        position_ = near || far ? target_ : Vec3(position_ + kStep * way.normalized());
        message.x = position_.x();
        message.y = position_.y();
        message.z = position_.z();
      }
      publisher_.publish(message);
    }
  }

  void accept(const topic_tools::ShapeShifter& message) {
    double numbers[6];  // force, position: the whole content of OmniFeedback
    const std::lock_guard<std::mutex> lock(mutex_);
    ++count_;
    if (message.size() != sizeof numbers) {
      well_formed_ = false;
      return;
    }
    std::vector<unsigned char> bytes(sizeof numbers);
    ros::serialization::OStream stream(bytes.data(), sizeof numbers);
    message.write(stream);
    std::memcpy(numbers, bytes.data(), sizeof numbers);
    force_ = Vec3(numbers[0], numbers[1], numbers[2]);
    if (!force_.allFinite() || numbers[3] != 0.0 || numbers[4] != 0.0 || numbers[5] != 0.0)
      well_formed_ = false;
  }

  mutable std::mutex mutex_;
  Vec3 position_, target_, force_ = Vec3::Zero();
  std::atomic<bool> silent_{false}, stop_{false}, well_formed_{true};
  std::atomic<long> count_{0};
  ros::Publisher publisher_;
  ros::Subscriber subscriber_;
  std::thread thread_;
};

class DeviceTest : public testing::Test {
 protected:
  DeviceTest() : spinner_(2), diagnostics_(node_), driver_(node_) {
    spinner_.start();
    proxy_subscriber_ = node_.subscribe<geometry_msgs::PoseStamped>(
        "probe/proxy", 1, [this](const geometry_msgs::PoseStamped::ConstPtr& message) {
          proxy_height_ = message->pose.position.z;
        });
  }
  void TearDown() override {
    const long seen = driver_.count();
    EXPECT_TRUE(waitFor([&] { return driver_.count() > seen; })) << "forces stopped: a node died";
    EXPECT_TRUE(driver_.wellFormed());
  }

  void press() {
    ASSERT_TRUE(waitFor([this] { return diagnostics_.value("probe", "status") == "free"; }));
    driver_.moveTo(kPressed);
    ASSERT_TRUE(waitFor([this] { return driver_.force().y() > 0.1; })) << "nothing felt";
  }

  ros::NodeHandle node_;
  ros::AsyncSpinner spinner_;
  DiagnosticsListener diagnostics_;
  FakeDriver driver_;
  std::atomic<double> proxy_height_{0.0};
  ros::Subscriber proxy_subscriber_;
};

/// At rest the coupling is a spring: the probe feels K (proxy - device) upwards, the hand
/// force_scale times that along the driver's y. The tolerance of 2 % covers the creep of the cloth
/// between two readings.
TEST_F(DeviceTest, PressingIsFeltAlongTheDriversAxisInItsScale) {
  press();
  const double height = kHeight + kMetresPerUnit * kPressed.y();
  double expected = 0.0;
  EXPECT_TRUE(waitFor([&] {
    expected = kForceScale * kStiffness * (proxy_height_ - height);
    return expected > 0.1 && std::abs(driver_.force().y() - expected) < 0.02 * expected;
  })) << "force "
      << driver_.force().transpose() << " N, expected " << expected << " N along y";
  // The cloth is symmetric, and the probe presses its middle without friction.
  EXPECT_LT(std::hypot(driver_.force().x(), driver_.force().z()), 0.05 * driver_.force().y());
  // Diagnostics show the force on the hand, not twice as much, the force on the probe.
  EXPECT_TRUE(waitFor([&] {
    const double shown = diagnostics_.number("probe", "force [N]");
    return std::abs(shown - driver_.force().y()) < 0.05 * driver_.force().y();
  })) << "shown "
      << diagnostics_.number("probe", "force [N]") << " N, force " << driver_.force().y() << " N";
  driver_.moveTo(kAbove);
  EXPECT_TRUE(waitFor([this] { return driver_.force().isZero(0.0); }));
}

TEST_F(DeviceTest, ASilentDriverGetsZero) {
  press();
  driver_.silence(true);
  EXPECT_TRUE(waitFor([this] { return driver_.force().isZero(0.0); }));
  driver_.moveTo(kAbove);
  driver_.silence(false);
}

TEST_F(DeviceTest, APausedClothGivesZero) {
  press();
  std_srvs::SetBool pause;
  pause.request.data = true;
  ASSERT_TRUE(ros::service::call("/haptic_cloth/pause", pause));
  EXPECT_TRUE(waitFor([this] { return driver_.force().isZero(0.0); }));
  pause.request.data = false;
  ASSERT_TRUE(ros::service::call("/haptic_cloth/pause", pause));
  driver_.moveTo(kAbove);
}

/// An adapter by itself; the test sends its input instead of the node.
class AdapterTest : public testing::Test {
 protected:
  AdapterTest() : spinner_(2) { spinner_.start(); }

  /// Starts an adapter, and connects to it as node and driver.
  void start(const std::vector<std::string>& parameters) {
    startWithoutDriver(parameters);
    connectDriver();
  }
  void startWithoutDriver(const std::vector<std::string>& parameters) {
    std::vector<std::string> command{programDirectory() + "/device_adapter",
                                     "__name:=alone",
                                     "probe/pose:=alone/pose",
                                     "probe/reaction:=alone/reaction",
                                     "device/pose:=alone/device_pose",
                                     "device/force:=alone/device_force"};
    command.insert(command.end(), parameters.begin(), parameters.end());
    process_ = std::make_unique<Process>(command);
    reaction_ = node_.advertise<geometry_msgs::WrenchStamped>("alone/reaction", 1);
    ASSERT_TRUE(waitFor([this] { return reaction_.getNumSubscribers() > 0; })) << process_->output();
  }
  void connectDriver() {
    force_ = node_.subscribe<geometry_msgs::Wrench>("alone/device_force", 1000,
                                                    [this](const geometry_msgs::Wrench::ConstPtr& message) {
                                                      newest_ = message->force.z;
                                                      finite_ = finite_ && std::isfinite(message->force.z);
                                                    });
    ASSERT_TRUE(waitFor([this] { return force_.getNumPublishers() > 0; })) << process_->output();
  }
  void TearDown() override {
    process_.reset();
    ros::param::del("/alone");
  }

  void send(double force) {
    geometry_msgs::WrenchStamped wrench;
    wrench.wrench.force.z = force;
    reaction_.publish(wrench);
  }
  /// Sends until `condition` holds.
  bool sendUntil(double force, const std::function<bool()>& condition) {
    return waitFor([&] {
      send(force);
      return condition();
    });
  }

  ros::NodeHandle node_;
  ros::AsyncSpinner spinner_;
  std::unique_ptr<Process> process_;
  ros::Publisher reaction_;
  std::atomic<double> newest_{0.0};
  std::atomic<bool> finite_{true};
  ros::Subscriber force_;  ///< last member: its callback uses all members above
};

TEST_F(AdapterTest, ANodeThatFallsSilentLeavesNoForce) {
  start({});
  ASSERT_TRUE(sendUntil(1.5, [this] { return newest_ == 1.5; }));
  EXPECT_TRUE(waitFor([this] { return newest_ == 0.0; }));
}

/// The force rises for so long that the test sees only its beginning. Criterion: the straight line from the
/// first message on, at the start and after a silence.
TEST_F(AdapterTest, AfterASilenceTheForceRisesSoftly) {
  constexpr double kForce = 1.5, kRise = 1000.0;  // [N], [s]
  start({"_force/soft_start:=1000.0"});
  for (int time = 0; time < 2; ++time) {
    const double begin = steadyNow();
    double largest = 0.0;
    ASSERT_TRUE(sendUntil(kForce, [&] {
      largest = std::max<double>(largest, newest_);
      return largest > 0.0 && steadyNow() - begin > 1.0;
    }));
    EXPECT_LE(largest, kForce * (steadyNow() - begin) / kRise);
    ASSERT_TRUE(waitFor([this] { return newest_ == 0.0; }));
  }
}

/// The node may send long before the driver takes forces. Criterion: the straight line from the moment when
/// the driver subscribes.
TEST_F(AdapterTest, ADriverThatComesLateFeelsTheForceRise) {
  constexpr double kForce = 1.5, kRise = 1000.0, kLate = 2.0;  // [N], [s], [s]
  startWithoutDriver({"_force/soft_start:=1000.0"});
  const double begin = steadyNow();
  ASSERT_TRUE(sendUntil(kForce, [&] { return steadyNow() - begin > kLate; }));
  const double subscribed = steadyNow();
  // The type is learnt by and by, while the node sends on.
  std::thread driver([this] { connectDriver(); });
  EXPECT_TRUE(sendUntil(kForce, [this] { return newest_ > 0.0; }));
  EXPECT_LE(newest_, kForce * (steadyNow() - subscribed) / kRise);
  driver.join();
}

TEST_F(AdapterTest, AForceThatIsNotFiniteIsZero) {
  start({"_force/timeout:=1000.0"});  // disables the watchdog for this test
  ASSERT_TRUE(sendUntil(1.5, [this] { return newest_ == 1.5; }));
  send(std::numeric_limits<double>::quiet_NaN());
  EXPECT_TRUE(waitFor([this] { return newest_ == 0.0; }));
  EXPECT_TRUE(finite_);
}

TEST_F(AdapterTest, ZeroIsTheLastThatGoesOut) {
  start({"_force/timeout:=1000.0"});
  ASSERT_TRUE(sendUntil(1.5, [this] { return newest_ == 1.5; }));
  process_->signal(SIGTERM);
  EXPECT_EQ(process_->wait(), 0) << process_->output();
  EXPECT_TRUE(waitFor([this] { return newest_ == 0.0; }));
}

TEST_F(AdapterTest, ADriversPositionIsAPose) {
  start({"_pose/frame_id:=tool"});
  std::mutex mutex;
  geometry_msgs::PoseStamped pose;
  const ros::Subscriber poses = node_.subscribe<geometry_msgs::PoseStamped>(
      "alone/pose", 1, [&](const geometry_msgs::PoseStamped::ConstPtr& message) {
        const std::lock_guard<std::mutex> lock(mutex);
        pose = *message;
      });
  ros::Publisher device = node_.advertise<geometry_msgs::Twist>("alone/device_pose", 1);
  geometry_msgs::Twist message;
  message.linear.y = 0.25;
  message.angular.y = 7.0;
  EXPECT_TRUE(waitFor([&] {
    device.publish(message);
    const std::lock_guard<std::mutex> lock(mutex);
    return pose.pose.position.y == 0.25;
  })) << process_->output();
  const std::lock_guard<std::mutex> lock(mutex);
  EXPECT_EQ(pose.header.frame_id, "tool");
  EXPECT_FALSE(pose.header.stamp.isZero());
  EXPECT_EQ(pose.pose.orientation.w, 1.0);
}

/// roscpp keeps to the type that a subscription has received first.
TEST_F(AdapterTest, ADriverWithAnotherTypeIsHeard) {
  start({});
  std::atomic<double> height{0.0};
  const ros::Subscriber poses = node_.subscribe<geometry_msgs::PoseStamped>(
      "alone/pose", 1,
      [&](const geometry_msgs::PoseStamped::ConstPtr& message) { height = message->pose.position.z; });
  const auto sender = [](const std::string& type, const std::string& value) {
    return std::make_unique<Process>(
        std::vector<std::string>{"rostopic", "pub", "-r", "50", "/alone/device_pose", type, value});
  };
  std::unique_ptr<Process> driver = sender("geometry_msgs/Point", "{z: 1.0}");
  ASSERT_TRUE(waitFor([&] { return height == 1.0; })) << process_->output();
  driver = nullptr;
  driver = sender("geometry_msgs/Twist", "{linear: {z: 2.0}}");
  EXPECT_TRUE(waitFor([&] { return height == 2.0; })) << process_->output();
}

/// Two other nodes send without pause, each its own height. Criterion: the adapter changes from one to the
/// other only after 50 ms of silence, so at most so often as 50 ms fit into the time, however busy the
/// machine is.
TEST_F(AdapterTest, ASecondDriverDoesNotThrowTheProbeToAndFro) {
  constexpr double kSilence = 0.05, kSpan = 2.0;  // [s]
  start({});
  std::mutex mutex;
  std::vector<double> heights;
  const ros::Subscriber poses = node_.subscribe<geometry_msgs::PoseStamped>(
      "alone/pose", 1000, [&](const geometry_msgs::PoseStamped::ConstPtr& message) {
        const std::lock_guard<std::mutex> lock(mutex);
        heights.push_back(message->pose.position.z);
      });
  const auto sender = [](const std::string& height) {
    return std::make_unique<Process>(std::vector<std::string>{"rostopic", "pub", "-r", "200",
                                                              "/alone/device_pose", "geometry_msgs/Twist",
                                                              "[0, 0, " + height + "]", "[0, 0, 0]"});
  };
  std::unique_ptr<Process> first = sender("1.0"), second = sender("2.0");
  ASSERT_TRUE(waitFor([&] { return process_->output().find("are dropped as long as") != std::string::npos; }))
      << process_->output();
  const double begin = steadyNow();
  {
    const std::lock_guard<std::mutex> lock(mutex);
    heights.clear();
  }
  sleepUntil(begin + kSpan);
  first.reset();
  const std::lock_guard<std::mutex> lock(mutex);
  int changes = 0;
  for (std::size_t k = 1; k < heights.size(); ++k) changes += heights[k] != heights[k - 1];
  EXPECT_GT(heights.size(), 0U);
  EXPECT_LE(changes, 1 + static_cast<int>((steadyNow() - begin) / kSilence));
}

TEST_F(AdapterTest, BadParametersAreNamed) {
  const auto expectRefused = [](const std::vector<std::string>& arguments, const std::string& word) {
    std::vector<std::string> command{programDirectory() + "/device_adapter", "__name:=alone"};
    command.insert(command.end(), arguments.begin(), arguments.end());
    Process process(command);
    EXPECT_EQ(process.wait(), 2) << process.output();
    EXPECT_NE(process.output().find(word), std::string::npos) << process.output();
    ros::param::del("/alone");
  };
  expectRefused({"_force/typ:=x"}, "force/typ");
  expectRefused({"_force/type:=nowhere/Unknown"}, "nowhere/Unknown");
  expectRefused({"device/pose:=probe/pose"}, "must be another topic");
}

/// A button by itself; the test sends its input and takes its grasp instead of the node.
class GraspButtonTest : public testing::Test {
 protected:
  GraspButtonTest() : spinner_(2) {
    spinner_.start();
    grasp_ = node_.subscribe<std_msgs::Bool>(
        "alone/grasp", 10, [this](const std_msgs::Bool::ConstPtr& message) { closed_ = message->data; });
    joy_ = node_.advertise<sensor_msgs::Joy>("alone/joy", 1);
  }
  void TearDown() override {
    process_.reset();
    ros::param::del("/alone");
  }

  void start(const std::string& number) {
    process_ = std::make_unique<Process>(
        std::vector<std::string>{programDirectory() + "/grasp_button", "__name:=alone", "_number:=" + number,
                                 "probe/grasp:=alone/grasp", "device/button:=alone/joy"});
    ASSERT_TRUE(waitFor([this] { return joy_.getNumSubscribers() > 0 && grasp_.getNumPublishers() > 0; }))
        << process_->output();
  }
  void send(const std::vector<int>& buttons) {
    sensor_msgs::Joy message;
    message.buttons = buttons;
    joy_.publish(message);
  }

  ros::NodeHandle node_;
  ros::AsyncSpinner spinner_;
  std::unique_ptr<Process> process_;
  ros::Publisher joy_;
  std::atomic<bool> closed_{false};
  ros::Subscriber grasp_;  ///< last member: its callback uses all members above
};

TEST_F(GraspButtonTest, TheGraspIsClosedWhileTheButtonIsHeld) {
  start("1");
  send({1, 0});
  send({1, 1});
  ASSERT_TRUE(waitFor([this] { return closed_.load(); })) << process_->output();
  send({1, 0});
  EXPECT_TRUE(waitFor([this] { return !closed_; }));
}

TEST_F(GraspButtonTest, ADriverThatEndsLetsGo) {
  start("0");
  send({1});
  ASSERT_TRUE(waitFor([this] { return closed_.load(); })) << process_->output();
  joy_.shutdown();
  EXPECT_TRUE(waitFor([this] { return !closed_; }));
}

TEST_F(GraspButtonTest, LetsGoAtItsEnd) {
  start("0");
  send({1});
  ASSERT_TRUE(waitFor([this] { return closed_.load(); })) << process_->output();
  process_->signal(SIGTERM);
  EXPECT_EQ(process_->wait(), 0) << process_->output();
  EXPECT_TRUE(waitFor([this] { return !closed_; }));
}

TEST_F(GraspButtonTest, AButtonThatIsNotThereIsNamed) {
  start("2");
  send({1, 1});
  EXPECT_TRUE(waitFor([this] {
    return process_->output().find("no button ~number = 2: sensor_msgs/Joy has 2") != std::string::npos;
  })) << process_->output();
  EXPECT_FALSE(closed_);
  process_ = std::make_unique<Process>(
      std::vector<std::string>{programDirectory() + "/grasp_button", "__name:=alone", "_number:=-1"});
  EXPECT_EQ(process_->wait(), 2);
  EXPECT_NE(process_->output().find("number = -1"), std::string::npos) << process_->output();
}

/// The driver's button through grasp_button and node: the pressed probe holds cloth, then lets go.
TEST_F(DeviceTest, HoldingTheButtonGrasps) {
  ros::Publisher button = node_.advertise<std_msgs::Int8MultiArray>("driver/button_state", 1);
  ASSERT_TRUE(waitFor([&] { return button.getNumSubscribers() > 0; }));
  const auto send = [&](signed char held) {
    std_msgs::Int8MultiArray message;
    message.data = {held, 0};
    button.publish(message);
  };
  press();
  send(1);
  EXPECT_TRUE(waitFor([this] { return diagnostics_.value("probe", "grasp") == "holds cloth"; }));
  send(0);
  EXPECT_TRUE(waitFor([this] { return diagnostics_.value("probe", "grasp") == "open"; }));
  driver_.moveTo(kAbove);
}

/// This test must be last, because the doubt remains. Millimetres taken as metres are a thousand
/// times too far.
TEST_F(DeviceTest, PosesThatCannotBeMetresAreNamedInTheDiagnostics) {
  EXPECT_EQ(diagnostics_.value("probe", "units").find("position_unit"), std::string::npos);
  driver_.moveTo(1e3 * kAbove);
  EXPECT_TRUE(waitFor([this] {
    return diagnostics_.value("probe", "units").find("device/position_unit") != std::string::npos;
  }));
}

}  // namespace
}  // namespace haptic_cloth::device_test

int main(int argc, char** argv) {
  testing::InitGoogleTest(&argc, argv);
  ros::init(argc, argv, "ros_device_test");
  return RUN_ALL_TESTS();
}
