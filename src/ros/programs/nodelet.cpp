/// The nodelet: the node inside another process, for instance beside a device driver. The manager closes its
/// topics at once when it gets a signal; only an unload sends the last zero wrench. A driver without a
/// command watchdog of its own is safer with the node.
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
      NODELET_FATAL_STREAM(error.what());  // the manager only says that it failed
      throw;
    }
    timer_ = getNodeHandle().createWallTimer(ros::WallDuration(0.1),
                                             [this](const ros::WallTimerEvent&) { check(); });
  }

  /// The nodelet's main: what ends a thread here must not end the manager with all its nodelets.
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
