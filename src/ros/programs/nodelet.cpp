/// The nodelet: the node inside another process, for instance that of a device driver. A nodelet
/// manager that gets a signal closes its topics at once, so only an unload sends the last zero
/// wrench. A driver without its own watchdog is safer with the node.
#include <nodelet/nodelet.h>

#include <exception>
#include <memory>
#include <pluginlib/class_list_macros.hpp>

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
    timer_ = getNodeHandle().createWallTimer(ros::WallDuration(0.1),
                                             [this](const ros::WallTimerEvent&) { check(); });
  }

  /// Checks the threads. An exception in one of them must not end the manager with all its
  /// nodelets.
  void check() {
    try {
      if (server_) server_->check();
    } catch (const std::exception& error) {
      NODELET_FATAL_STREAM("stopped: " << error.what());
      server_.reset();
    }
  }

  std::unique_ptr<HapticClothServer> server_;
  ros::WallTimer timer_;
};

}  // namespace haptic_cloth

PLUGINLIB_EXPORT_CLASS(haptic_cloth::HapticClothNodelet, nodelet::Nodelet)
