/// The node. Ends with 0 when asked to, 2 for bad parameters, 1 for anything else; force zero always last.
#include <ros/ros.h>
#include <ros/xmlrpc_manager.h>
#include <signal.h>

#include <atomic>
#include <cstdio>
#include <exception>

#include "haptic_cloth/error.h"
#include "ros/server.h"

namespace {

/// SIGINT, SIGTERM and SIGHUP, blocked in every thread so that this one can wait for them: a handler could
/// not send the last wrench.
class Signals {
 public:
  Signals() {
    sigemptyset(&set_);
    for (const int signal : {SIGINT, SIGTERM, SIGHUP}) sigaddset(&set_, signal);
    pthread_sigmask(SIG_BLOCK, &set_, nullptr);
  }
  /// @return whether a signal came within `milliseconds`
  bool wait(long milliseconds) const {
    const timespec timeout{0, milliseconds * 1000000};
    return sigtimedwait(&set_, nullptr, &timeout) > 0;
  }

 private:
  sigset_t set_;
};

/// `rosnode kill`, and the master when another node takes this name. roscpp's own answer would close the
/// publishers before the last wrench is out.
void answerShutdownCall(std::atomic<bool>& asked) {
  const auto& manager = ros::XMLRPCManager::instance();
  manager->unbind("shutdown");
  manager->bind("shutdown", [&asked](XmlRpc::XmlRpcValue&, XmlRpc::XmlRpcValue& result) {
    asked = true;
    result = ros::xmlrpc::responseInt(1, "", 0);
  });
}

int run(int argc, char** argv) {
  // Waits for the master if there are parameters on the command line; until here a signal just ends it.
  ros::init(argc, argv, "haptic_cloth", ros::init_options::NoSigintHandler);
  const Signals signals;
  std::atomic<bool> asked{false};
  for (bool told = false; !ros::master::check(); told = true) {
    if (!told) ROS_WARN_STREAM("waiting for the ROS master at " << ros::master::getURI());
    if (signals.wait(500)) return 0;
  }
  ros::NodeHandle node, private_node("~");
  answerShutdownCall(asked);
  haptic_cloth::HapticClothServer server(node, private_node);
  ROS_INFO("ready");
  while (!asked && ros::ok() && !signals.wait(100)) server.check();
  server.stop();
  return 0;
}

}  // namespace

int main(int argc, char** argv) {
  try {
    return run(argc, argv);
  } catch (const haptic_cloth::InputError& error) {
    std::fprintf(stderr, "haptic_cloth: %s\n", error.what());
    return 2;
  } catch (const std::exception& error) {
    std::fprintf(stderr, "haptic_cloth: %s\n", error.what());
    return 1;
  }
}
