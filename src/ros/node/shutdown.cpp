#include "ros/node/shutdown.h"

#include <ros/console.h>
#include <ros/master.h>
#include <ros/xmlrpc_manager.h>

#include <cstdlib>
#include <stdexcept>
#include <thread>

#include "ros/node/steady_clock.h"

namespace haptic_cloth {

Signals::Signals() {
  sigemptyset(&set_);
  for (const int signal : {SIGINT, SIGTERM, SIGHUP, SIGQUIT, SIGALRM, SIGUSR1, SIGUSR2})
    sigaddset(&set_, signal);
  pthread_sigmask(SIG_BLOCK, &set_, nullptr);
  signal(SIGTSTP, SIG_IGN);
}

bool Signals::wait(long milliseconds) const {
  const timespec timeout{0, milliseconds * 1000000};
  return sigtimedwait(&set_, nullptr, &timeout) > 0;
}

void answerShutdownCall(std::atomic<bool>& asked) {
  const auto answer = [&asked](XmlRpc::XmlRpcValue& call, XmlRpc::XmlRpcValue& result) {
    asked = true;
    // The caller and its reason, such as a new node of the same name.
    if (call.getType() == XmlRpc::XmlRpcValue::TypeArray && call.size() > 1)
      ROS_WARN_STREAM("ending, as " << call[0] << " asks: " << call[1]);
    result = ros::xmlrpc::responseInt(1, "", 0);
  };
  if (!ros::XMLRPCManager::instance()->bind("shutdown", answer))
    throw std::logic_error("answerShutdownCall() comes before the first NodeHandle");
}

void endWithin(double seconds) {
  const double end = steadyNow() + seconds;
  std::thread([end] {
    sleepUntil(end);
    std::_Exit(0);
  }).detach();
}

bool waitForMaster(const Signals& signals) {
  for (bool told = false; !ros::master::check(); told = true) {
    if (!told) ROS_WARN_STREAM("waiting for the ROS master at " << ros::master::getURI());
    if (signals.wait(500)) return false;
  }
  return true;
}

}  // namespace haptic_cloth
