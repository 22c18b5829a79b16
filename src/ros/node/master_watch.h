/// Life without the ROS master.
#pragma once

#include <atomic>
#include <cstdint>
#include <string>
#include <vector>

namespace haptic_cloth {

/// Looks once a second whether the master is there and knows this node. Connections between nodes need no
/// master, so its loss changes nothing for the hand; but roscpp never registers again with a new master, and
/// then nobody new could find the node. So this does, without touching the connections there are.
class MasterWatch {
 public:
  /// @param services full names of the services this node offers
  explicit MasterWatch(const std::vector<std::string>& services) : services_(services) {}

  /// Runs until `stop`.
  void run(const std::atomic<bool>& stop);

  bool reachable() const { return reachable_; }

  /// How often the node has registered anew.
  std::uint64_t renewals() const { return renewals_; }

 private:
  void look();
  /// @return whether the master knows the node and all its services
  bool isKnown() const;
  /// @return whether the master took everything
  bool registerAnew() const;

  std::vector<std::string> services_;
  bool incomplete_ = false;  ///< the last registration must be repeated
  int unknown_ = 0;          ///< looks in a row at which the master did not know this node
  std::atomic<bool> reachable_{true};
  std::atomic<std::uint64_t> renewals_{0};
};

}  // namespace haptic_cloth
