/// The nodelet: the node inside another process, for instance that of a device driver. An unload
/// and a signal to the manager send the last zero wrench; `rosnode kill` of the manager closes its
/// topics at once. A driver without its own watchdog is safer with the node.
#include <nodelet/nodelet.h>

#include <exception>
#include <memory>
#include <mutex>
#include <optional>
#include <pluginlib/class_list_macros.hpp>

#include "ros/node/before_signals.h"
#include "ros/node/server.h"

namespace haptic_cloth {

class HapticClothNodelet : public nodelet::Nodelet {
 private:
  void onInit() override {
    try {
      const ros::NodeHandle private_node = getPrivateNodeHandle();
      server_ =
          std::make_unique<HapticClothServer>(getNodeHandle(), private_node, *readParameters(private_node));
    } catch (const std::exception& error) {
      NODELET_FATAL_STREAM(error.what());  // the manager reports only that loading failed
      throw;
    }
    before_signals_.emplace([this] {
      const std::lock_guard<std::mutex> lock(mutex_);
      server_->stop();
    });
    timer_ = getNodeHandle().createWallTimer(ros::WallDuration(0.1),
                                             [this](const ros::WallTimerEvent&) { check(); });
  }

  /// Checks the threads. An exception in one of them must not end the manager with all its
  /// nodelets.
  void check() {
    try {
      const std::lock_guard<std::mutex> lock(mutex_);
      if (server_) server_->check();
    } catch (const std::exception& error) {
      NODELET_FATAL_STREAM("stopped: " << error.what());
      before_signals_.reset();
      server_.reset();
    }
  }

  std::mutex mutex_;  ///< because check() and stop() are called by two threads
  std::unique_ptr<HapticClothServer> server_;
  std::optional<BeforeSignals> before_signals_;  ///< destroyed before server_, which it stops
  ros::WallTimer timer_;
};

}  // namespace haptic_cloth

PLUGINLIB_EXPORT_CLASS(haptic_cloth::HapticClothNodelet, nodelet::Nodelet)
