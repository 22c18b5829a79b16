/// Many subscribers of one topic, each with its own connection, like as many processes; and
/// subscribers that stop reading, like a program that hangs.
#pragma once

#include <atomic>
#include <string>
#include <thread>
#include <vector>

namespace haptic_cloth {

/// Speaks TCPROS itself, because subscribers within one roscpp process would share one connection.
class RawListeners {
 public:
  /// @param node full name of the publisher  @param topic full name
  /// @throws std::runtime_error if the node refuses
  RawListeners(const std::string& node, const std::string& topic, int count);
  ~RawListeners();

  /// Stops reading: bytes stay in the connections until resume().
  void stall() { stalled_ = true; }
  void resume() { stalled_ = false; }

  /// Messages of the subscriber with the fewest.
  long fewest() const;
  /// Number of connections that the node has closed.
  int closed() const { return closed_; }

 private:
  struct Connection {
    int socket = -1;
    std::vector<char> bytes;  ///< part of a message that is not yet complete
    long messages = -1;       ///< -1, because the publisher's header comes first
  };
  void open(const std::string& host, int port, const std::string& topic, int number);
  void run();
  void read(Connection& connection);

  std::vector<Connection> connections_;
  std::atomic<long> fewest_{0};
  std::atomic<int> closed_{0};
  std::atomic<bool> stalled_{false}, stop_{false};
  std::thread thread_;
};

}  // namespace haptic_cloth
