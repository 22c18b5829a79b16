/// Options that may change while the node runs, and how a new set of them is formed. Pure
/// functions.
#pragma once

#include <cstdint>
#include <map>
#include <memory>
#include <string>
#include <variant>
#include <vector>

#include "haptic_cloth/haptics.h"
#include "haptics/gain_ramp.h"
#include "ros/options/node_options.h"

namespace haptic_cloth {

using LiveValue = std::variant<bool, int, double, std::string>;
using LiveValues = std::map<std::string, LiveValue>;  ///< by name

/// One live option for the tools. Its name is that of the private parameter with its initial value.
struct LiveOption {
  std::string name;
  std::string description;
  LiveValue low, high;               ///< ends of the slider, or false and true; the rules may allow more
  std::vector<std::string> choices;  ///< words that it accepts; empty if it takes a number
};

/// All live options of a node. Each probe has its own.
std::vector<LiveOption> offeredOptions(const NodeOptions& options);

/// Values of all live options.
LiveValues liveValues(const NodeOptions& options);

/// The options with some values changed, checked as a whole.
/// @throws InputError with option, value and rule, also for names that are not live
NodeOptions changed(const NodeOptions& options, const LiveValues& values, const std::string& origin);

/// A complete set of options for the threads. They read it in place, so nothing is copied, freed or
/// counted there.
struct LiveOptions {
  std::uint64_t number = 0;  ///< counts up; 0: options at start
  std::shared_ptr<const NodeOptions> options;
  std::vector<GainRamp> gains;  ///< ramps to the gains in the options, one per probe
};

/// View of the live options by one thread or callback.
class LiveReader {
 public:
  explicit LiveReader(Mailbox<LiveOptions>& mailbox) : mailbox_(mailbox) {}

  /// Reads the newest set. @return whether it differs from that of the last call
  bool readNew() {
    newest_ = &mailbox_.read();
    const bool other = newest_->number != seen_;
    seen_ = newest_->number;
    return other;
  }

  /// Set that was read last. @pre readNew() was called, and no other reader has read the mailbox
  /// since
  const LiveOptions& newest() const { return *newest_; }

 private:
  Mailbox<LiveOptions>& mailbox_;
  const LiveOptions* newest_ = nullptr;
  std::uint64_t seen_ = 0;
};

/// Set at the start of the node.
LiveOptions firstOptions(const NodeOptions& options);

/// Set that follows `last`. @param now steady clock at which its ramps start [s]
LiveOptions nextOptions(const LiveOptions& last, const NodeOptions& options, double now);

}  // namespace haptic_cloth
