/// The options that may change while the node runs: which they are, and how a new set of them comes to be.
/// Pure functions.
#pragma once

#include <cstdint>
#include <functional>
#include <map>
#include <memory>
#include <string>
#include <variant>
#include <vector>

#include "haptic_cloth/haptics.h"
#include "haptics/gain_ramp.h"
#include "ros/options/node_options.h"

namespace haptic_cloth {

using LiveValue = std::variant<int, double, std::string>;
using LiveValues = std::map<std::string, LiveValue>;  ///< by name

/// One of them. Its name is that of the private parameter that gives it at the start.
struct LiveOption {
  using Field = std::variant<int*, double*, MeshColouring*>;
  std::string name;
  std::string description;
  LiveValue low, high;                       ///< ends of a slider; the rules may allow more
  std::function<Field(NodeOptions&)> field;  ///< where it stands
  std::function<LiveValue(const NodeOptions&)> value;
};

/// All that a node with these options offers. Several probes have their options each.
std::vector<LiveOption> offeredOptions(const NodeOptions& options);

/// The words that an option takes; empty where it takes a number.
std::vector<std::string> choices(const LiveOption& option);

/// The options with some values changed, checked as a whole.
/// @throws InputError naming option, value and rule, for names that are not offered too
NodeOptions changed(const NodeOptions& options, const LiveValues& values, const std::string& origin);

/// A whole set as the threads take it over. They read it in place: nothing is copied, freed or counted there.
struct LiveOptions {
  std::uint64_t number = 0;  ///< counts up; 0: the node still runs as it started
  std::shared_ptr<const NodeOptions> options;
  std::vector<GainRamp> gains;  ///< of every probe, to those of the options
};

/// One thread's or one callback's view of them.
class LiveReader {
 public:
  explicit LiveReader(Mailbox<LiveOptions>& mailbox) : mailbox_(mailbox) {}

  /// Reads the newest set. @return whether it is another than at the last call
  bool readNew() {
    newest_ = &mailbox_.read();
    const bool other = newest_->number != seen_;
    seen_ = newest_->number;
    return other;
  }

  /// What was read last. @pre readNew(), and no other reader of the mailbox since
  const LiveOptions& newest() const { return *newest_; }

 private:
  Mailbox<LiveOptions>& mailbox_;
  const LiveOptions* newest_ = nullptr;
  std::uint64_t seen_ = 0;
};

/// What the node starts with.
LiveOptions firstOptions(const NodeOptions& options);

/// The set after `last`. @param now steady clock [s]: from here its gains move
LiveOptions nextOptions(const LiveOptions& last, const NodeOptions& options, double now);

}  // namespace haptic_cloth
