/// Reads one level of a parameter tree key by key.
#pragma once

#include <xmlrpcpp/XmlRpcValue.h>

#include <set>
#include <string>
#include <vector>

#include "scene/option.h"

namespace haptic_cloth {

/// Takes the known members out of one level of the tree; the others are unknown. If a key is
/// absent, read() does not change the value.
class ParameterGroup {
 public:
  /// @param origin source for error messages
  /// @param path path of this level: empty, or ending in a slash
  /// @throws InputError if the tree is neither a mapping nor empty
  ParameterGroup(const XmlRpc::XmlRpcValue& tree, const std::string& origin, const std::string& path = "");

  /// Reads and checks options. A quaternion must be almost of norm 1 (isRotation()) and is normalised.
  /// @throws InputError for a wrong type or value, like all functions below
  void read(const Options& options);

  /// Reads the options of a group, and refuses its removed keys.
  void read(const OptionGroup& group);

  /// Reads the first of the groups, which is this level, and the others from their levels below it.
  /// Levels below have no other members; those of this one remain for the caller.
  void read(const std::vector<OptionGroup>& groups);

  ParameterGroup group(const std::string& key);

  /// Members that were not read, as a mapping.
  XmlRpc::XmlRpcValue rest() const;

  /// @throws InputError if there are members that were not read
  void rejectRest() const;

  /// @param others members that are read elsewhere
  /// @throws InputError if there are more
  void rejectRestBut(const std::vector<std::string>& others) const;

 private:
  bool has(const std::string& key) const;
  struct Reader;
  /// Reads the groups directly below `path`, the path of this level, and those below them.
  void readBelow(const std::string& path, const std::vector<OptionGroup>& groups);
  /// Reads a number, or a list of `count` finite numbers.
  std::vector<double> numbers(const std::string& key, std::size_t count) const;
  [[noreturn]] void fail(const std::string& key, const std::string& rule) const;

  XmlRpc::XmlRpcValue tree_;
  std::string origin_;
  std::string path_;
  std::set<std::string> known_;
};

}  // namespace haptic_cloth
