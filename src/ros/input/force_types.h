/// Message types by which drivers take forces.
#pragma once

#include <map>
#include <optional>
#include <string>

namespace haptic_cloth {

struct ForceType {
  std::string datatype;                ///< package/Name
  std::string definition;              ///< as in a connection header
  std::map<std::string, int> lengths;  ///< lengths of variable arrays that must not be empty
};

/// Type with this name, if it is known. For a driver's own type only the part after the slash
/// counts, because forks of a driver move it between packages.
std::optional<ForceType> findForceType(const std::string& datatype);

}  // namespace haptic_cloth
