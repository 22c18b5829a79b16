/// Measures whether topics flow: counts messages and checks their numbers.
#pragma once

#include <haptic_cloth/ClothState.h>
#include <ros/node_handle.h>

#include <cstdint>
#include <deque>
#include <limits>
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

  /// Topics that have not delivered a message since clear(), joined by commas.
  std::string missing() const;
  void clear();

  /// Report on the last `seconds` in one line.
  std::string line(double seconds) const;

  /// Verdict on the last `seconds` in one line, which begins with PASS or FAIL.
  std::string verdict(double seconds, bool& passed) const;

 private:
  /// Proxies come with the states, if their probe is present. So many states in a row may lack a
  /// proxy that is on its way.
  static constexpr int kAbsent = 3;
  struct Probe {
    Flow reaction;
    double force = 0.0;            ///< newest [N]
    double max_force = 0.0;        ///< since clear [N]
    double height = 0.0;           ///< newest z of the proxy [m]
    int states_without = kAbsent;  ///< states of the cloth since the newest proxy
    ros::Subscriber reaction_subscriber, proxy_subscriber;
  };
  void subscribe(ros::NodeHandle& node, const std::string& name, Probe& probe);
  std::vector<const Flow*> flows() const;
  void note(const ClothState& state);
  double realTimeFactor() const { return elapsed_ > 0.0 ? simulated_ / elapsed_ : 0.0; }

  static constexpr double kNoGap = std::numeric_limits<double>::infinity();

  std::deque<Probe> probes_;  ///< a deque, because callbacks refer to the elements
  Flow markers_, state_;
  std::size_t cells_ = 0;
  int rung_ = 0, worst_rung_ = 0;                ///< of the newest state, and the largest since clear
  double slipped_ = 0.0;                         ///< of the newest state [s]
  unsigned pairs_ = 0, most_pairs_ = 0;          ///< self-contacts: of the newest state, and most since clear
  double gap_ = kNoGap, smallest_gap_ = kNoGap;  ///< of layers: of the newest state, and since clear [m]
  std::uint64_t failed_ = 0, out_of_reach_ = 0;  ///< steps, of the newest state
  double time_ = 0.0, received_ = -1.0;          ///< of the newest state: simulated, and steady clock [s]
  double simulated_ = 0.0, elapsed_ = 0.0;       ///< by all states since clear, without resets [s]
  ros::Subscriber markers_subscriber_, state_subscriber_;
};

}  // namespace haptic_cloth
