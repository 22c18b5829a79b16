#include "ros/node/server.h"

#include <diagnostic_msgs/DiagnosticArray.h>
#include <haptic_cloth/ClothState.h>
#include <ros/callback_queue.h>
#include <ros/spinner.h>
#include <ros/this_node.h>
#include <std_srvs/Empty.h>
#include <std_srvs/SetBool.h>
#include <tf2_ros/buffer.h>
#include <visualization_msgs/MarkerArray.h>

#include <array>
#include <chrono>
#include <deque>
#include <future>
#include <optional>
#include <utility>
#include <vector>

#include "ros/display/display_thread.h"
#include "ros/haptic/haptic_thread.h"
#include "ros/haptic/probe_topics.h"
#include "ros/input/obstacle_topics.h"
#include "ros/input/transform_input.h"
#include "ros/node/file_work.h"
#include "ros/node/master_watch.h"
#include "ros/node/real_time.h"
#include "ros/node/solver_loop.h"
#include "ros/node/state_services.h"
#include "ros/node/steady_clock.h"
#include "ros/node/topics.h"
#include "ros/options/node_options.h"
#include "ros/options/reconfigure_server.h"

namespace haptic_cloth {
namespace {

constexpr double kFlush = 0.05;  ///< time for the last wrench to leave the process [s]

DisplayPublishers advertise(ros::NodeHandle& node) {
  return {node.advertise<visualization_msgs::MarkerArray>(topics::kMarkers, topics::kMarkersQueue),
          node.advertise<ClothState>(topics::kState, topics::kStateQueue),
          node.advertise<diagnostic_msgs::DiagnosticArray>(topics::kDiagnostics, topics::kDiagnosticsQueue)};
}

/// Thread that answers some of the services, so that a service that waits does not delay the
/// others.
struct ServiceThread {
  ros::CallbackQueue queue;
  ros::AsyncSpinner spinner{1, &queue};

  /// Node handle whose services this thread answers.
  ros::NodeHandle handle(const ros::NodeHandle& node) {
    ros::NodeHandle own(node);
    own.setCallbackQueue(&queue);
    return own;
  }
};

}  // namespace

std::optional<NodeInput> readParameters(const ros::NodeHandle& private_node,
                                        const std::function<bool()>& called_off) {
  XmlRpc::XmlRpcValue tree;
  private_node.getParam(private_node.getNamespace(), tree);
  const std::string origin = private_node.getNamespace() + " (parameters)";
  const auto input = std::make_shared<NodeInput>();
  const auto read = [input, tree, origin] {
    input->options = parseNodeOptions(tree, origin);
    const std::string& record = input->options.record;
    if (!record.empty()) input->recording = openRecording(record, origin);
  };
  if (!runFileWork(read, called_off)) return std::nullopt;
  return std::move(*input);
}

class HapticClothServer::Implementation {
 public:
  Implementation(const ros::NodeHandle& node, const ros::NodeHandle& private_node, NodeInput input)
      : options_(std::move(input.options)),
        shared_(options_),
        solver_(options_, shared_, std::move(input.recording)),
        node_(node),
        private_node_(private_node),
        transform_input_(transforms_),
        probes_(offerProbes()),
        obstacles_(offerObstacles()),
        haptics_(options_, publishers(), shared_),
        master_(private_node_.getNamespace(), services(), outputs()),
        display_(options_, advertise(node_), {name(), probes_, obstacles_, haptics_, master_}, shared_),
        pose_spinner_(1, &pose_queue_) {
    for (const std::string& warning : startWarnings(options_)) ROS_WARN_STREAM(warning);
    offerServices();
    try {
      startThreads();
    } catch (...) {
      shared_.stop = true;  // the futures wait for their threads
      throw;
    }
  }

  ~Implementation() { stop(); }

  void check() {
    for (std::future<void>& thread : threads_) {
      if (!thread.valid() || thread.wait_for(std::chrono::seconds(0)) != std::future_status::ready) continue;
      stop();
      thread.get();
    }
  }

  void stop() {
    if (shared_.stop.exchange(true)) return;
    pose_spinner_.stop();
    for (ServiceThread* thread : serviceThreads()) thread->spinner.stop();
    for (std::future<void>& thread : threads_) thread.wait();
    sleepUntil(steadyNow() + kFlush);
  }

 private:
  /// @throws std::system_error, boost::thread_resource_error if the system has no thread left
  void startThreads() {
    const auto start = [this](auto work) { threads_.push_back(std::async(std::launch::async, work)); };
    start([this] { solver_.run(); });
    start([this] { haptics_.run(); });
    start([this] { display_.run(); });
    start([this] { master_.run(shared_.stop); });
    prioritiseMessages(pose_queue_);
    pose_spinner_.start();
    for (ServiceThread* thread : serviceThreads()) thread->spinner.start();
  }

  std::deque<ProbeTopics> offerProbes() {
    std::deque<ProbeTopics> probes;
    for (std::size_t k = 0; k < options_.scene.probes.size(); ++k) {
      probes.emplace_back(options_, k, transforms_, node_, Queues{pose_queue_, quick_thread_.queue}, shared_);
    }
    return probes;
  }

  std::deque<ObstacleTopics> offerObstacles() {
    std::deque<ObstacleTopics> obstacles;
    const FrameLookup frames(options_.frame_id, transforms_);
    for (std::size_t k = 0; k < options_.scene.obstacles.size(); ++k) {
      const Obstacle& obstacle = options_.scene.obstacles[k];
      if (obstacle.name.empty()) continue;
      obstacles.emplace_back(obstacle, frames, node_, pose_queue_, shared_.obstacles[k]);
    }
    return obstacles;
  }

  std::vector<ProbePublishers> publishers() const {
    std::vector<ProbePublishers> publishers;
    for (const ProbeTopics& probe : probes_) publishers.push_back({probe.reaction(), probe.command()});
    return publishers;
  }

  /// Name without the first slash. A nodelet's name differs from that of its process.
  std::string name() const { return private_node_.getNamespace().substr(1); }

  /// Full names of all services of this node.
  std::vector<std::string> services() const {
    std::vector<std::string> names{
        private_node_.resolveName(topics::kReset),      private_node_.resolveName(topics::kPause),
        private_node_.resolveName(topics::kSaveState),  private_node_.resolveName(topics::kLoadState),
        private_node_.resolveName(topics::kSetOptions), ros::this_node::getName() + "/get_loggers",
        ros::this_node::getName() + "/set_logger_level"};
    for (const ProbeTopics& probe : probes_) names.push_back(probe.service());
    return names;
  }

  /// Full names of the topics that devices follow.
  std::vector<std::string> outputs() const {
    std::vector<std::string> names;
    for (const ProbeTopics& probe : probes_) {
      names.push_back(probe.reaction().getTopic());
      names.push_back(probe.command().getTopic());  // "" without one
    }
    return names;
  }

  void offerServices() {
    ros::NodeHandle quick = quick_thread_.handle(private_node_), reset = reset_thread_.handle(private_node_);
    pause_service_ = quick.advertiseService(topics::kPause, &Implementation::pause, this);
    reset_service_ = reset.advertiseService(topics::kReset, &Implementation::reset, this);
    reconfigure_.emplace(options_, options_thread_.handle(private_node_), shared_);
    state_services_.emplace(save_thread_.handle(private_node_), load_thread_.handle(private_node_),
                            options_.scene, shared_);
  }

  std::array<ServiceThread*, 5> serviceThreads() {
    return {&quick_thread_, &reset_thread_, &options_thread_, &save_thread_, &load_thread_};
  }

  bool reset(std_srvs::Empty::Request&, std_srvs::Empty::Response&) {
    return shared_.tasks.run([](SolverLoop& loop) { loop.reset(); }, shared_.stop);
  }

  bool pause(std_srvs::SetBool::Request& request, std_srvs::SetBool::Response& response) {
    shared_.paused = request.data;
    if (request.data) {
      for (SharedProbe& probe : shared_.probes) probe.session().setGrasp(false);
    }
    response.success = true;
    response.message = request.data ? "paused" : "running";
    return true;
  }

  // The order matters: parameters and scene are checked before anything is advertised.
  NodeOptions options_;
  SharedState shared_;
  SolverLoop solver_;
  ros::NodeHandle node_, private_node_;
  tf2_ros::Buffer transforms_;
  TransformInput transform_input_;
  ros::CallbackQueue pose_queue_;
  ServiceThread quick_thread_;                   ///< pause and grasps, which never wait
  ServiceThread reset_thread_, options_thread_;  ///< may wait for the solver and for the master
  ServiceThread save_thread_, load_thread_;      ///< may wait for the file system
  std::deque<ProbeTopics> probes_;
  std::deque<ObstacleTopics> obstacles_;
  HapticThread haptics_;
  MasterWatch master_;
  DisplayThread display_;
  ros::ServiceServer reset_service_, pause_service_;
  std::optional<StateServices> state_services_;
  std::optional<ReconfigureServer> reconfigure_;
  ros::AsyncSpinner pose_spinner_;
  std::vector<std::future<void>> threads_;
};

HapticClothServer::HapticClothServer(const ros::NodeHandle& node, const ros::NodeHandle& private_node,
                                     NodeInput input)
    : implementation_(std::make_unique<Implementation>(node, private_node, std::move(input))) {}

HapticClothServer::~HapticClothServer() = default;

void HapticClothServer::check() { implementation_->check(); }

void HapticClothServer::stop() { implementation_->stop(); }

}  // namespace haptic_cloth
