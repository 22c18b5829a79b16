#include "ros/node/master_watch.h"

#include <ros/connection_manager.h>
#include <ros/console.h>
#include <ros/master.h>
#include <ros/network.h>
#include <ros/publication.h>
#include <ros/this_node.h>
#include <ros/topic_manager.h>
#include <ros/xmlrpc_manager.h>
#include <xmlrpcpp/XmlRpcClient.h>
#include <xmlrpcpp/XmlRpcException.h>
#include <xmlrpcpp/XmlRpcValue.h>

#include <algorithm>

#include "ros/node/steady_clock.h"

namespace haptic_cloth {
namespace {

constexpr double kPeriod = 1.0;  ///< interval between two checks [s]
constexpr double kPoll = 0.05;   ///< interval between two checks of the stop flag [s]

/// Calls the master; fails at once if it does not answer. The first argument is always the caller's
/// name.
bool call(const std::string& method, const std::vector<std::string>& arguments,
          XmlRpc::XmlRpcValue& payload) {
  XmlRpc::XmlRpcValue request, response;
  request[0] = ros::this_node::getName();
  for (std::size_t i = 0; i < arguments.size(); ++i) request[static_cast<int>(i) + 1] = arguments[i];
  return ros::master::execute(method, request, response, payload, false);
}

/// Calls roscpp in this process, as the master does.
XmlRpc::XmlRpcValue callSelf(const char* method, XmlRpc::XmlRpcValue request) {
  request[0] = "/master";
  XmlRpc::XmlRpcClient self(ros::network::getHost().c_str(), ros::XMLRPCManager::instance()->getServerPort(),
                            "/");
  XmlRpc::XmlRpcValue response;
  return self.execute(method, request, response) ? response : XmlRpc::XmlRpcValue();
}

/// Addresses of the publishers of each topic to which this process is connected.
std::multimap<std::string, std::string> connectedPublishers() {
  std::multimap<std::string, std::string> connected;
  XmlRpc::XmlRpcValue answer = callSelf("getBusInfo", {});
  if (answer.getType() != XmlRpc::XmlRpcValue::TypeArray) return connected;
  XmlRpc::XmlRpcValue& connections = answer[2];
  for (int k = 0; k < connections.size(); ++k) {
    XmlRpc::XmlRpcValue& each = connections[k];  // number, peer, direction, transport, topic
    if (static_cast<std::string>(each[2]) == "i")
      connected.emplace(static_cast<std::string>(each[4]), static_cast<std::string>(each[1]));
  }
  return connected;
}

/// Passes the publishers of a topic to roscpp, as the master does when they change. roscpp leaves those that
/// are not among them, so the list has those of which a new master does not know, too.
/// @param known to the master
void connectTo(const std::string& topic, XmlRpc::XmlRpcValue known,
               const std::multimap<std::string, std::string>& connected) {
  if (known.getType() != XmlRpc::XmlRpcValue::TypeArray || known.size() == 0) return;
  const auto [begin, end] = connected.equal_range(topic);
  for (auto publisher = begin; publisher != end; ++publisher) known[known.size()] = publisher->second;
  XmlRpc::XmlRpcValue request;
  request[1] = topic;
  request[2] = known;
  callSelf("publisherUpdate", request);
}

}  // namespace

void MasterWatch::run(const std::atomic<bool>& stop) {
  double due = steadyNow() + kPeriod;
  while (!stop) {
    sleepUntil(steadyNow() + kPoll);
    if (steadyNow() < due) continue;
    try {
      look();
    } catch (const XmlRpc::XmlRpcException& error) {
      ROS_WARN_STREAM_THROTTLE(60.0, "the ROS master gave an unexpected answer: " << error.getMessage());
    }
    due = steadyNow() + kPeriod;
  }
}

void MasterWatch::look() {
  const bool reachable = ros::master::check();
  if (reachable != reachable_) {
    ROS_WARN_STREAM("ROS master " << (reachable ? "found again" : "lost; connected peers stay connected"));
  }
  // A master that was lost may be a new one that knows only a part of this node: what was being
  // registered. So everything is registered again. A master that already knows it changes nothing.
  if (reachable && !reachable_) incomplete_ = true;
  reachable_ = reachable;
  if (reachable) findOtherPublishers();
  unknown_ = !reachable || isKnown() ? 0 : unknown_ + 1;
  // Two checks in a row are needed, because a node that is being renamed or killed is briefly
  // unknown.
  if (unknown_ < 2 && !(incomplete_ && reachable)) return;
  unknown_ = 0;
  incomplete_ = !registerAgain();
  if (incomplete_) return;
  ++renewals_;
  ROS_WARN("registered again with the ROS master");
  XmlRpc::XmlRpcValue known;
  if (call("hasParam", {parameters_}, known) && !static_cast<bool>(known))
    ROS_WARN(
        "this master has no parameters of the node. It goes on with those it started with; programs that "
        "read them (path_hand, mouse_hand, monitor) need them loaded again");
}

/// A device that gets messages of two nodes follows them in turn.
void MasterWatch::findOtherPublishers() {
  XmlRpc::XmlRpcValue state;
  if (!call("getSystemState", {}, state)) return;
  XmlRpc::XmlRpcValue& published = state[0];  // pairs of a topic and its publishers
  std::map<std::string, std::string> found;
  for (int k = 0; k < published.size(); ++k) {
    const auto topic = static_cast<std::string>(published[k][0]);
    if (std::find(outputs_.begin(), outputs_.end(), topic) == outputs_.end()) continue;
    XmlRpc::XmlRpcValue& nodes = published[k][1];
    for (int i = 0; i < nodes.size(); ++i) {
      const auto node = static_cast<std::string>(nodes[i]);
      if (node == ros::this_node::getName()) continue;
      std::string& others = found[topic];
      others += (others.empty() ? "" : ", ") + node;
    }
  }
  for (const auto& [topic, others] : found) {
    if (others != otherPublishers(topic))
      ROS_WARN_STREAM(topic << " is also published by " << others << ": the device gets messages of both");
  }
  const std::lock_guard<std::mutex> lock(mutex_);
  others_ = found;
}

std::string MasterWatch::otherPublishers(const std::string& output) const {
  const std::lock_guard<std::mutex> lock(mutex_);
  const auto found = others_.find(output);
  return found == others_.end() ? "" : found->second;
}

bool MasterWatch::isKnown() const {
  XmlRpc::XmlRpcValue payload;
  bool known = call("lookupNode", {ros::this_node::getName()}, payload);
  for (const std::string& service : services_) known = known && call("lookupService", {service}, payload);
  return known;
}

bool MasterWatch::registerAgain() const {
  const std::string uri = ros::XMLRPCManager::instance()->getServerURI();
  XmlRpc::XmlRpcValue payload;
  std::vector<std::string> advertised, subscribed;  // roscpp appends to what it gets
  bool complete = true;
  ros::this_node::getAdvertisedTopics(advertised);
  for (const std::string& topic : advertised) {
    const ros::PublicationPtr publication = ros::TopicManager::instance()->lookupPublication(topic);
    if (publication) complete &= call("registerPublisher", {topic, publication->getDataType(), uri}, payload);
  }
  ros::this_node::getSubscribedTopics(subscribed);
  const std::multimap<std::string, std::string> connected = connectedPublishers();
  for (const std::string& topic : subscribed) {
    const bool taken = call("registerSubscriber", {topic, "*", uri}, payload);
    if (taken) connectTo(topic, payload, connected);
    complete &= taken;
  }
  const std::string service_uri = "rosrpc://" + ros::network::getHost() + ":" +
                                  std::to_string(ros::ConnectionManager::instance()->getTCPPort());
  for (const std::string& service : services_) {
    complete &= call("registerService", {service, service_uri, uri}, payload);
  }
  return complete;
}

}  // namespace haptic_cloth
