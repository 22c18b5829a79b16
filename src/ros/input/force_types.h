/// Messages by which drivers take forces.
#pragma once

#include <map>
#include <optional>
#include <string>

namespace haptic_cloth {

struct ForceType {
  std::string datatype;                ///< package/Name
  std::string definition;              ///< as in a connection header
  std::map<std::string, int> lengths;  ///< of arrays of variable length that must not be empty
};

/// What is known of a type. Types of drivers go by their name alone: forks of a driver move them between
/// packages.
std::optional<ForceType> findForceType(const std::string& datatype);

}  // namespace haptic_cloth
