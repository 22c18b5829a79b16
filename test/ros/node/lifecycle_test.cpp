/// Start and end of the node: bad parameters, signals, rosnode kill, a lost master.
#include <dynamic_reconfigure/Reconfigure.h>
#include <gtest/gtest.h>
#include <haptic_cloth/LoadState.h>
#include <haptic_cloth/SaveState.h>
#include <ros/ros.h>
#include <signal.h>
#include <std_srvs/Empty.h>
#include <std_srvs/SetBool.h>
#include <unistd.h>

#include <algorithm>
#include <cstdlib>
#include <filesystem>
#include <fstream>
#include <memory>
#include <thread>
#include <utility>
#include <vector>

#include "ros/node/steady_clock.h"
#include "ros/support/ros_test_support.h"

namespace haptic_cloth::lifecycle_test {
namespace {

const std::string kScene = std::string(HAPTIC_CLOTH_SOURCE_DIR) + "/test/ros/support/scene.yaml";

std::vector<std::string> nodeCommand(const std::vector<std::string>& parameters) {
  std::vector<std::string> command{programDirectory() + "/haptic_cloth_node", "__name:=cloth"};
  command.insert(command.end(), parameters.begin(), parameters.end());
  return command;
}

/// Command of the node whose output can be read while it runs.
std::vector<std::string> readableCommand() {
  std::vector<std::string> command = nodeCommand({"_scene_file:=" + kScene});
  command.insert(command.begin(), {"stdbuf", "-oL"});
  return command;
}

bool waitUntilReady(const Process& process) {
  return waitFor([&] { return process.output().find("ready") != std::string::npos; });
}

/// A roslaunch of this package that is ended only after it has started all of its nodes. A signal
/// before that locks roslaunch for 20 s, and it may leave nodes behind.
class Launch {
 public:
  /// @param nodes names of the nodes that the launch file starts
  Launch(const std::vector<std::string>& arguments, std::vector<std::string> nodes)
      : nodes_(std::move(nodes)) {
    std::vector<std::string> command{"roslaunch", "haptic_cloth"};
    command.insert(command.end(), arguments.begin(), arguments.end());
    process_ = std::make_unique<Process>(command);
  }

  /// @return whether roslaunch has started all nodes and the cloth is ready
  bool ready() const {
    return waitFor([this] {
      const std::string text = output();
      const auto isStarted = [&](const std::string& node) {
        return text.find("process[" + node + "-") != std::string::npos;
      };
      return std::all_of(nodes_.begin(), nodes_.end(), isStarted) && servesReset();
    });
  }

  /// Sends SIGINT. @return whether roslaunch ended and left no cloth behind
  bool end() {
    process_->signal(SIGINT);
    return process_->wait() >= 0 && waitFor([] { return !servesReset(); });
  }

  bool running() { return process_->running(); }
  std::string output() const { return process_->output(); }

 private:
  static bool servesReset() { return ros::service::exists("/haptic_cloth/reset", false); }

  std::unique_ptr<Process> process_;
  std::vector<std::string> nodes_;
};

class LifecycleTest : public testing::Test {
 protected:
  LifecycleTest() : spinner_(2) { spinner_.start(); }
  void TearDown() override { ros::param::del("/cloth"); }

  /// Starts a node whose probe presses on the cloth and feels a force.
  void startPressed(const std::vector<std::string>& environment = {}) {
    process_ = std::make_unique<Process>(nodeCommand({"_scene_file:=" + kScene}), environment);
    reaction_ = std::make_unique<ReactionListener>(node_, "probe/reaction");
    device_ = std::make_unique<TestDevice>(node_, Vec3(0.0, 0.0, 0.125));
    // A press starts with the probe clear of the cloth.
    const DiagnosticsListener diagnostics(node_);
    ASSERT_TRUE(waitFor([&] { return diagnostics.value("probe", "status") == "free"; }));
    device_->moveTo(Vec3(0.0, 0.0, 0.100));
    ASSERT_TRUE(waitFor([this] { return reaction_->force().z() > 0.1; })) << process_->output();
  }

  void expectZeroAtTheEnd() {
    EXPECT_EQ(process_->wait(), 0) << process_->output();
    EXPECT_TRUE(waitFor([this] { return reaction_->force() == Vec3::Zero(); })) << "the force was left on";
    EXPECT_TRUE(reaction_->finite());
  }

  void expectRefused(const std::vector<std::string>& parameters, const std::string& word) {
    Process process(nodeCommand(parameters));
    EXPECT_EQ(process.wait(), 2) << process.output();
    EXPECT_NE(process.output().find(word), std::string::npos) << process.output();
    ros::param::del("/cloth");
  }

  ros::NodeHandle node_;
  ros::AsyncSpinner spinner_;
  std::unique_ptr<Process> process_;
  std::unique_ptr<ReactionListener> reaction_;
  std::unique_ptr<TestDevice> device_;
};

TEST_F(LifecycleTest, SigtermSendsZeroLast) {
  startPressed();
  process_->signal(SIGTERM);
  expectZeroAtTheEnd();
}

TEST_F(LifecycleTest, SigintSendsZeroLast) {
  startPressed();
  process_->signal(SIGINT);
  expectZeroAtTheEnd();
}

TEST_F(LifecycleTest, CtrlBackslashSendsZeroLast) {
  startPressed();
  process_->signal(SIGQUIT);
  expectZeroAtTheEnd();
}

TEST_F(LifecycleTest, CtrlZDoesNotStopTheNode) {
  // A device would hold the force of a stopped node for ever.
  startPressed();
  process_->signal(SIGTSTP);
  device_->moveTo(Vec3(0.0, 0.0, 0.125));
  EXPECT_TRUE(waitFor([this] { return reaction_->force() == Vec3::Zero(); })) << "the node stands still";
  process_->signal(SIGTERM);
  expectZeroAtTheEnd();
}

TEST_F(LifecycleTest, RosnodeKillSendsZeroLast) {
  startPressed();
  Process kill({"rosnode", "kill", "/cloth"});
  EXPECT_EQ(kill.wait(), 0) << kill.output();
  expectZeroAtTheEnd();
}

/// Service calls that may not return before the node ends.
class PendingCalls {
 public:
  explicit PendingCalls(Process& node) : node_(node) {}
  ~PendingCalls() {
    if (node_.running()) node_.signal(SIGKILL);
    for (std::thread& call : calls_) call.join();
  }
  template <class Service>
  void start(const std::string& name, const std::string& file) {
    calls_.emplace_back([name, file] {
      Service service;
      service.request.file = file;
      ros::service::call(name, service);
    });
  }

 private:
  Process& node_;
  std::vector<std::thread> calls_;
};

TEST_F(LifecycleTest, AFileSystemThatDoesNotAnswerHoldsUpNobody) {
  char directory[] = "/tmp/haptic_cloth_test_XXXXXX";
  ASSERT_NE(mkdtemp(directory), nullptr);
  const std::filesystem::path here = directory;
  std::ofstream(here / "slow_disk") << "never read";
  startPressed({"LD_PRELOAD=" HAPTIC_CLOTH_SLOW_DISK});
  if (HasFatalFailure()) return;
  PendingCalls pending(*process_);
  pending.start<LoadState>("/cloth/load_state", here / "slow_disk");
  ASSERT_TRUE(waitFor([&] { return std::filesystem::exists(here / "waiting_to_load"); }));
  pending.start<SaveState>("/cloth/save_state", here / "slow_disk.state");
  ASSERT_TRUE(waitFor([&] { return std::filesystem::exists(here / "waiting_to_save"); }))
      << "loading holds up saving";
  EXPECT_GT(reaction_->force().z(), 0.1) << "the force goes on";

  std_srvs::SetBool pause;
  pause.request.data = true;
  ASSERT_TRUE(ros::service::call("/cloth/pause", pause));
  EXPECT_TRUE(waitFor([this] { return reaction_->force() == Vec3::Zero(); }));
  pause.request.data = false;
  ASSERT_TRUE(ros::service::call("/cloth/pause", pause));
  std_srvs::Empty reset;
  EXPECT_TRUE(ros::service::call("/cloth/reset", reset));
  dynamic_reconfigure::Reconfigure options;
  EXPECT_TRUE(ros::service::call("/cloth/set_parameters", options));
  process_->signal(SIGTERM);
  expectZeroAtTheEnd();
  std::filesystem::remove_all(here);
}

TEST_F(LifecycleTest, ASceneThatCannotBeReadDoesNotKeepTheNodeFromEnding) {
  char directory[] = "/tmp/haptic_cloth_test_XXXXXX";
  ASSERT_NE(mkdtemp(directory), nullptr);
  const std::filesystem::path here = directory, scene = here / "slow_disk.yaml";
  std::filesystem::copy_file(kScene, scene);
  Process process(nodeCommand({"_scene_file:=" + scene.string()}), {"LD_PRELOAD=" HAPTIC_CLOTH_SLOW_DISK});
  ASSERT_TRUE(waitFor([&] { return std::filesystem::exists(here / "waiting_to_load"); })) << process.output();
  process.signal(SIGTERM);
  EXPECT_EQ(process.wait(), 0) << process.output();
  std::filesystem::remove_all(here);
}

TEST_F(LifecycleTest, NodesInTwoNamespacesAreToldApart) {
  const DiagnosticsListener diagnostics(node_);
  Process left(nodeCommand({"__ns:=left", "_scene_file:=" + kScene}));
  Process right(nodeCommand({"__ns:=right", "_scene_file:=" + kScene}));
  for (const char* const name : {"left/cloth: probe", "right/cloth: probe", "left/cloth: solver"})
    EXPECT_TRUE(waitFor([&] { return diagnostics.heard(name); })) << name;
  for (Process* node : {&left, &right}) {
    node->signal(SIGTERM);
    EXPECT_EQ(node->wait(), 0) << node->output();
  }
  ros::param::del("/left");
  ros::param::del("/right");
}

/// A device that follows two nodes in turn is a mistake that neither of them feels.
TEST_F(LifecycleTest, ASecondPublisherOfAForceIsNamed) {
  const DiagnosticsListener diagnostics(node_);
  const auto others = [&] { return diagnostics.value("probe", "other publishers"); };
  const std::string own = ros::this_node::getName();
  Process process(readableCommand());
  ASSERT_TRUE(waitFor([&] { return others() == "none"; })) << process.output();
  {
    const ros::Publisher second = node_.advertise<geometry_msgs::WrenchStamped>("probe/reaction", 1);
    EXPECT_TRUE(waitFor([&] { return others() == own; }));
  }
  EXPECT_TRUE(waitFor([&] { return others() == "none"; }));
  const std::string warning = "/probe/reaction is also published by " + own, output = process.output();
  EXPECT_NE(output.find(warning), std::string::npos) << output;
  EXPECT_EQ(output.find(warning), output.rfind(warning)) << "once a change: " << output;
  process.signal(SIGTERM);
  EXPECT_EQ(process.wait(), 0);
}

TEST_F(LifecycleTest, BadParametersAreNamed) {
  const std::string scene = "_scene_file:=" + kScene;
  expectRefused({}, "cloth");
  expectRefused({scene, "_colour:=red"}, "colour");
  expectRefused({scene, "_haptics/max_farce:=3.0"}, "haptics/max_farce");
  expectRefused({scene, "_haptics/max_force:=-1.0"}, "haptics/max_force");
  expectRefused({scene, "_max_pose_age:=soon"}, "max_pose_age");
  expectRefused({scene, "_probe/radius:=-0.01"}, "probe.radius");
  expectRefused({"_scene_file:=/nowhere/scene.yaml"}, "/nowhere/scene.yaml");
  for (const std::string file : {"/nowhere/session", "/tmp", "/dev/full", "/etc/hostname"})
    expectRefused({scene, "_step_budget:=0.0", "_record:=" + file}, "record = " + file);
}

/// It must not reset a cloth that others work on, which is the first thing that it does to the node.
TEST_F(LifecycleTest, APathHandWithoutPathsEndsWithAnError) {
  Process node(readableCommand());
  ASSERT_TRUE(waitUntilReady(node)) << node.output();
  Process hand({programDirectory() + "/path_hand", "_node:=/cloth"});
  EXPECT_EQ(hand.wait(), 2);
  EXPECT_NE(hand.output().find("no probe of the scene has a path"), std::string::npos) << hand.output();
}

TEST_F(LifecycleTest, AHandSaysThatItsNodeHasNoParameters) {
  for (const char* const program : {"/path_hand", "/mouse_hand"}) {
    Process hand({programDirectory() + program, "_node:=nope"});
    EXPECT_EQ(hand.wait(), 2);
    EXPECT_NE(hand.output().find("/nope: no parameters; is `node` right?"), std::string::npos)
        << hand.output();
  }
}

/// Parameters of earlier launches or runs do not act on a launch that does not name them.
TEST_F(LifecycleTest, ALaunchForgetsEarlierParameters) {
  const auto forgets = [](const std::vector<std::string>& arguments, const std::vector<std::string>& nodes,
                          const std::vector<std::string>& earlier) {
    for (const std::string& name : earlier) ros::param::set(name, 1);
    Launch launch(arguments, nodes);
    EXPECT_TRUE(launch.ready()) << launch.output();
    for (const std::string& name : earlier) EXPECT_FALSE(ros::param::has(name)) << name;
    EXPECT_TRUE(launch.end()) << launch.output();
  };
  forgets({"device.launch", "driver:=chai3d", "scene:=" + kScene},
          {"haptic_cloth", "device_adapter", "grasp_button"},
          {"/device_adapter/force/timeout", "/grasp_button/earlier"});
  EXPECT_TRUE(ros::param::has("/grasp_button/number")) << "an argument of the launch file";
  forgets({"demo.launch", "mouse:=true", "rviz:=false", "scene:=" + kScene}, {"haptic_cloth", "mouse_hand"},
          {"/mouse_hand/rate"});
  forgets({"demo.launch", "path:=true", "hand:=false", "rviz:=false", "scene:=" + kScene},
          {"haptic_cloth", "path_hand"}, {"/path_hand/rate", "/path_hand/node"});
  EXPECT_TRUE(ros::param::has("/path_hand/repeat_after"));
  for (const char* const node : {"/haptic_cloth", "/grasp_button", "/path_hand"}) ros::param::del(node);
}

TEST_F(LifecycleTest, RespawnDoesNotRepeatBadParameters) {
  // roslaunch restarts every program that ends, so this one must not end: it reports one error and
  // waits for a signal.
  char settings[] = "/tmp/haptic_cloth_test_XXXXXX";
  const int file = mkstemp(settings);
  ASSERT_GE(file, 0);
  const std::string text = "haptics: {max_force: -1.0}\n";
  ASSERT_EQ(write(file, text.data(), text.size()), static_cast<ssize_t>(text.size()));
  close(file);
  Launch launch(
      {"haptic_cloth.launch", "respawn:=true", "scene:=" + kScene, std::string("settings:=") + settings},
      {"haptic_cloth"});
  const auto errors = [&] {
    const std::string output = launch.output(), rule = "must be > 0";
    int count = 0;
    for (auto at = output.find(rule); at != std::string::npos; at = output.find(rule, at + 1)) ++count;
    return count;
  };
  ASSERT_TRUE(waitFor([&] { return errors() > 0; })) << launch.output();
  sleepUntil(steadyNow() + 5.0);  // a node that ends is restarted after 0.5 to 1.5 s
  EXPECT_EQ(errors(), 1) << launch.output();
  EXPECT_EQ(launch.output().find("restarting"), std::string::npos) << launch.output();
  EXPECT_TRUE(launch.running()) << launch.output();
  EXPECT_TRUE(launch.end()) << launch.output();
  unlink(settings);
  ros::param::del("/haptic_cloth");
}

TEST_F(LifecycleTest, ALaunchedSceneFindsTheFabricBesideIt) {
  // rosparam gives the node only the content of the scene; the launch file adds its folder.
  char directory[] = "/tmp/haptic_cloth_test_XXXXXX";
  ASSERT_NE(mkdtemp(directory), nullptr);
  const std::filesystem::path here = directory;
  std::filesystem::copy_file(std::string(HAPTIC_CLOTH_SOURCE_DIR) + "/config/fabrics/linear.yaml",
                             here / "mine.yaml");
  std::ofstream(here / "scene.yaml") << "cloth: {particles: [5, 5], fabric: mine.yaml}\n";
  Launch launch({"haptic_cloth.launch", "scene:=" + (here / "scene.yaml").string()}, {"haptic_cloth"});
  EXPECT_TRUE(launch.ready()) << launch.output();
  EXPECT_TRUE(launch.end()) << launch.output();
  std::filesystem::remove_all(here);
  ros::param::del("/haptic_cloth");
}

TEST_F(LifecycleTest, WaitsForTheMasterAndCanBeStoppedMeanwhile) {
  Process process(nodeCommand({}), {"ROS_MASTER_URI=http://localhost:9/"});
  ASSERT_TRUE(waitFor([&] { return process.output().find("waiting") != std::string::npos; }));
  process.signal(SIGTERM);
  EXPECT_EQ(process.wait(), 0);
}

TEST_F(LifecycleTest, AMasterThatDoesNotAnswerDoesNotKeepTheNodeFromEnding) {
  OwnMaster master;
  Process process(readableCommand(), {"ROS_MASTER_URI=" + master.uri()});
  ASSERT_TRUE(waitUntilReady(process)) << process.output();
  sleepUntil(steadyNow() + 2.0);  // roscpp asks the master for a parameter while it logs this
  master.signal(SIGSTOP);
  process.signal(SIGTERM);
  EXPECT_EQ(process.wait(), 0) << process.output();
}

TEST_F(LifecycleTest, ANewMasterFindsTheNodeAgain) {
  OwnMaster master;
  Process process(readableCommand(), {"ROS_MASTER_URI=" + master.uri()});
  ASSERT_TRUE(waitUntilReady(process)) << process.output();
  ASSERT_TRUE(master.knowsService("/cloth/reset"));
  master.kill();
  EXPECT_TRUE(waitFor([&] { return process.output().find("master lost") != std::string::npos; }));
  EXPECT_TRUE(process.running());
  master.start();
  EXPECT_TRUE(waitFor([&] { return master.knowsService("/cloth/reset"); })) << process.output();
  EXPECT_TRUE(master.knows("/cloth"));

  EXPECT_TRUE(waitFor(
      [&] { return process.output().find("registered again with the ROS master") != std::string::npos; }));
  Process info({"rostopic", "info", "/probe/reaction"}, {"ROS_MASTER_URI=" + master.uri()});
  EXPECT_EQ(info.wait(), 0);
  EXPECT_NE(info.output().find("Subscribers: None"), std::string::npos)
      << "the node is registered as a subscriber of its output: " << info.output();

  // A new subscriber finds the topic and gets the force: rostopic echo ends after one message.
  Process echo({"rostopic", "echo", "-n1", "/probe/reaction"}, {"ROS_MASTER_URI=" + master.uri()});
  EXPECT_EQ(echo.wait(), 0) << echo.output();
  process.signal(SIGTERM);
  EXPECT_EQ(process.wait(), 0);
  EXPECT_FALSE(master.knows("/cloth")) << "a dead node is left in the master";
}

}  // namespace
}  // namespace haptic_cloth::lifecycle_test

int main(int argc, char** argv) {
  testing::InitGoogleTest(&argc, argv);
  ros::init(argc, argv, "ros_lifecycle_test");
  return RUN_ALL_TESTS();
}
