/// Whether a topic flows: messages counted, numbers checked.
#pragma once

#include <ros/node_handle.h>

#include <cmath>
#include <deque>
#include <string>
#include <vector>

namespace haptic_cloth {

/// Counts one topic. All calls from one thread.
struct Flow {
  std::string name;
  double wanted = 0.0;  ///< lowest good rate [Hz]
  long count = 0;       ///< messages since the last clear
  bool finite = true;   ///< all numbers so far

  void add(bool good) {
    ++count;
    finite = finite && good;
  }
};

/// What the demonstration sends, counted by a subscriber that can follow 1 kHz.
class FlowMeter {
 public:
  /// @param probes their names
  FlowMeter(ros::NodeHandle& node, const std::vector<std::string>& probes, double reaction_rate,
            double display_rate);

  /// Whether every topic has sent something.
  bool allFlow() const;
  void clear();

  /// One line on the last `seconds`.
  std::string line(double seconds) const;

  /// One line that begins with PASS or FAIL, on the last `seconds`.
  std::string verdict(double seconds, bool& passed) const;

 private:
  struct Probe {
    Flow reaction;
    double force = 0.0;      ///< newest [N]
    double max_force = 0.0;  ///< since clear [N]
    double height = 0.0;     ///< of the proxy [m]
    ros::Subscriber reaction_subscriber, proxy_subscriber;
  };
  void subscribe(ros::NodeHandle& node, const std::string& name, Probe& probe);
  std::vector<const Flow*> flows() const;

  std::deque<Probe> probes_;  ///< stay where they are
  Flow markers_, state_;
  std::size_t cells_ = 0;
  /// When a state was simulated and when it came.
  struct Arrival {
    double time, received;  ///< [s]
  };
  Arrival newest_{}, first_{};  ///< the newest state, and the first of those counted
  ros::Subscriber markers_subscriber_, state_subscriber_;
};

}  // namespace haptic_cloth
