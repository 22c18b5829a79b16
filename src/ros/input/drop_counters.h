/// Counts of poses that an input takes and drops.
#pragma once

#include <atomic>
#include <cstdint>

namespace haptic_cloth {

/// Counts since start that all inputs have. Written by the pose thread, read by the display thread.
struct DropCounters {
  std::atomic<std::uint64_t> received{0}, not_finite{0}, unknown_frame{0}, too_far{0};
  std::atomic<std::uint64_t> bad_quaternion{0};  ///< poses taken with the last good orientation
  /// When a bad quaternion that should have turned the body last came, steady clock [s]. A device without
  /// orientation sends zeros, which do not matter to a sphere.
  std::atomic<double> bad_turn{-1e30};
  std::atomic<double> last_received{-1e30};                              ///< steady clock [s]
  std::atomic<double> last_dropped{-1e30};                               ///< steady clock [s]
  std::atomic<const std::atomic<std::uint64_t>*> last_counter{nullptr};  ///< of the last dropped message
  std::uint64_t dropped() const { return not_finite + unknown_frame + too_far; }

  /// @param when steady clock [s]
  void receive(double when) {
    ++received;
    last_received = when;
  }

  /// @param when steady clock [s]
  void drop(std::atomic<std::uint64_t>& counter, double when) {
    ++counter;
    last_counter = &counter;
    last_dropped = when;
  }
};

}  // namespace haptic_cloth
