/// One level of a parameter tree, read key by key.
#pragma once

#include <xmlrpcpp/XmlRpcValue.h>

#include <set>
#include <string>
#include <vector>

#include "haptic_cloth/types.h"

namespace haptic_cloth {

/// Takes the known members out of one level of the tree; what is left over is unknown. Reading a key that is
/// not there leaves the value as it is.
class ParameterGroup {
 public:
  /// @param origin names the source in messages
  /// @param path of this level, empty or with a slash at its end
  /// @throws InputError if the tree is neither a map nor nothing
  ParameterGroup(const XmlRpc::XmlRpcValue& tree, const std::string& origin, const std::string& path = "");

  /// @throws InputError for wrong types and values, as all below
  void read(const std::string& key, std::string& value);
  /// @return which of `choices` it is; `value` where the key is not there
  std::size_t readChoice(const std::string& key, const std::vector<std::string>& choices, std::size_t value);
  /// @param zero_is_good whether 0 is allowed beside positive values
  void read(const std::string& key, double& value, bool zero_is_good);
  void read(const std::string& key, bool& value);
  void read(const std::string& key, Vec3& value);
  /// A list x y z w. Off from norm 1 by at most 1e-3 it is normalised, as in a scene.
  void read(const std::string& key, Quat& value);

  ParameterGroup group(const std::string& key);

  /// The members nobody asked for, as a map.
  XmlRpc::XmlRpcValue rest() const;

  /// @throws InputError if there are such members
  void rejectRest() const;

  /// @param others members that somebody else will ask for
  /// @throws InputError if there are more
  void rejectRestBut(const std::vector<std::string>& others) const;

 private:
  bool has(const std::string& key) const;
  /// `count` finite numbers of a list.
  std::vector<double> numbers(const std::string& key, int count) const;
  [[noreturn]] void fail(const std::string& key, const std::string& rule) const;

  XmlRpc::XmlRpcValue tree_;
  std::string origin_;
  std::string path_;
  std::set<std::string> known_;
};

}  // namespace haptic_cloth
