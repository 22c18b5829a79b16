/// Measures whether topics flow: counts messages and checks their numbers.
#pragma once

#include <ros/node_handle.h>

#include <cmath>
#include <deque>
#include <string>
#include <vector>

namespace haptic_cloth {

/// Counter of one topic. Not thread-safe.
struct Flow {
  std::string name;
  double wanted = 0.0;  ///< lowest good rate [Hz]
  long count = 0;       ///< messages since the last clear
  bool finite = true;   ///< whether all numbers so far were finite

  void add(bool good) {
    ++count;
    finite = finite && good;
  }
};

/// Subscribes to the topics of the node and counts their messages. It can follow 1 kHz.
class FlowMeter {
 public:
  /// @param probes names of the probes
  FlowMeter(ros::NodeHandle& node, const std::vector<std::string>& probes, double reaction_rate,
            double display_rate);

  /// Whether every topic has delivered a message.
  bool allFlow() const;
  void clear();

  /// Report on the last `seconds` in one line.
  std::string line(double seconds) const;

  /// Verdict on the last `seconds` in one line, which begins with PASS or FAIL.
  std::string verdict(double seconds, bool& passed) const;

 private:
  struct Probe {
    Flow reaction;
    double force = 0.0;      ///< newest [N]
    double max_force = 0.0;  ///< since clear [N]
    double height = 0.0;     ///< z of the proxy [m]
    ros::Subscriber reaction_subscriber, proxy_subscriber;
  };
  void subscribe(ros::NodeHandle& node, const std::string& name, Probe& probe);
  std::vector<const Flow*> flows() const;

  std::deque<Probe> probes_;  ///< a deque, because callbacks refer to the elements
  Flow markers_, state_;
  std::size_t cells_ = 0;
  int rung_ = 0, worst_rung_ = 0;  ///< of the newest state, and the largest since clear
  double slipped_ = 0.0;           ///< of the newest state [s]
  /// Simulated time of a state, and when it was received.
  struct Arrival {
    double time, received;  ///< [s]
  };
  Arrival newest_{}, first_{};  ///< the newest state, and the first one counted
  ros::Subscriber markers_subscriber_, state_subscriber_;
};

}  // namespace haptic_cloth
