/// Files that states are kept in (docs/reference/states.md).
#pragma once

#include <cstdint>
#include <string>

#include "haptic_cloth/scene.h"

namespace haptic_cloth {

/// What every state begins with.
constexpr char kStateMagic[] = "haptic_cloth state\n";

/// No state of this scene is larger [bytes].
std::uint64_t largestState(const Scene& scene);

/// No state of any scene is larger [bytes].
std::uint64_t largestState();

/// Makes sure that a state may be written there: a new file in a directory that can be written, or
/// a regular file that holds a state or nothing. @throws InputError naming the file
void checkStateFile(const std::string& file);

/// Writes what Simulation::saveState() gave, under a temporary name of its own that becomes `file`
/// when all of it is on the disk: whatever happens, the file holds its old content or all of the
/// new.
/// @throws InputError as checkStateFile()  @throws OutputError naming the file and what went wrong
void writeStateFile(const std::string& file, const std::string& state);

/// Reads a regular file, and that only if it begins as a state and has the size that it says.
/// Nothing else is read: a device may give bytes without end, a FIFO none for ever.
/// @param most larger files are refused; largestState(scene)
/// @throws InputError naming a file that cannot be read
std::string readStateFile(const std::string& file, std::uint64_t most = largestState());

}  // namespace haptic_cloth
