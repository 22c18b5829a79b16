/// Keeps the node registered when the ROS master is lost and comes back.
#pragma once

#include <atomic>
#include <cstdint>
#include <string>
#include <vector>

namespace haptic_cloth {

/// Checks once a second whether the master is reachable and knows this node. Connections between
/// nodes need no master, so its loss does not affect the hand. But roscpp never registers with a
/// new master, and new nodes could not find this one. This class registers again; existing
/// connections stay.
class MasterWatch {
 public:
  /// @param services full names of the services of this node
  explicit MasterWatch(const std::vector<std::string>& services) : services_(services) {}

  /// Runs until `stop`.
  void run(const std::atomic<bool>& stop);

  bool reachable() const { return reachable_; }

  /// Number of times that everything was registered again.
  std::uint64_t renewals() const { return renewals_; }

 private:
  void look();
  /// @return whether the master knows the node and all its services
  bool isKnown() const;
  /// @return whether the master accepted everything
  bool registerAnew() const;

  std::vector<std::string> services_;
  bool incomplete_ = false;  ///< whether the last registration must be repeated
  int unknown_ = 0;          ///< checks in a row at which the master did not know this node
  std::atomic<bool> reachable_{true};
  std::atomic<std::uint64_t> renewals_{0};
};

}  // namespace haptic_cloth
