/// Files of saved states (docs/reference/states.md).
#pragma once

#include <cstdint>
#include <string>

#include "haptic_cloth/scene.h"

namespace haptic_cloth {

/// First bytes of every state.
constexpr char kStateMagic[] = "haptic_cloth state\n";

/// Upper bound for the size of a state of this scene [bytes].
std::uint64_t largestState(const Scene& scene);

/// Upper bound for the size of any state [bytes].
std::uint64_t largestState();

/// Checks that a state may be written to `file`: a new file in a writable directory, or a regular
/// file that is empty or holds a state.
/// @throws InputError naming the file
void checkStateFile(const std::string& file);

/// Writes the result of Simulation::saveState(). A temporary file is renamed to `file` once all of
/// it is on the disk, so `file` always holds its old or its new content completely.
/// @throws InputError as checkStateFile(), or if `state` does not begin as one or is cut off
/// @throws OutputError naming the file and the reason
void writeStateFile(const std::string& file, const std::string& state);

/// Reads a state from a regular file, after checking its header and size. Devices and FIFOs are
/// refused: they may deliver endless data or none.
/// @param most larger files are refused; normally largestState(scene)
/// @throws InputError if the file cannot be read or is not a state
std::string readStateFile(const std::string& file, std::uint64_t most = largestState());

}  // namespace haptic_cloth
