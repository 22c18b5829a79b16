/// Keeps the node registered when the ROS master is lost and comes back, and looks for nodes that
/// publish to the same devices.
#pragma once

#include <atomic>
#include <cstdint>
#include <map>
#include <mutex>
#include <string>
#include <vector>

namespace haptic_cloth {

/// Checks once a second whether the master is reachable and knows this node. Connections between
/// nodes need no master, so its loss does not affect the hand. But roscpp never registers with a
/// new master, and new nodes could not find this one. This class registers again; existing
/// connections stay.
class MasterWatch {
 public:
  /// @param parameters namespace of the parameters of this node
  /// @param services full names of the services of this node
  /// @param outputs full names of the topics that its devices follow
  MasterWatch(const std::string& parameters, const std::vector<std::string>& services,
              const std::vector<std::string>& outputs)
      : parameters_(parameters), services_(services), outputs_(outputs) {}

  /// Runs until `stop`.
  void run(const std::atomic<bool>& stop);

  bool reachable() const { return reachable_; }

  /// Number of times that everything was registered again.
  std::uint64_t renewals() const { return renewals_; }

  /// Names of the other nodes that publish an output; empty: none.
  std::string otherPublishers(const std::string& output) const;

 private:
  void look();
  void findOtherPublishers();
  /// @return whether the master knows the node and all its services
  bool isKnown() const;
  /// @return whether the master accepted everything
  bool registerAgain() const;

  std::string parameters_;
  std::vector<std::string> services_, outputs_;
  bool incomplete_ = false;  ///< whether the last registration must be repeated
  int unknown_ = 0;          ///< checks in a row at which the master did not know this node
  std::atomic<bool> reachable_{true};
  std::atomic<std::uint64_t> renewals_{0};
  mutable std::mutex mutex_;                   ///< of the member below
  std::map<std::string, std::string> others_;  ///< other publishers of each output that has some
};

}  // namespace haptic_cloth
