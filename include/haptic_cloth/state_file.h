/// Files that states are kept in (docs/formats.md).
#pragma once

#include <string>

namespace haptic_cloth {

/// What every state begins with.
constexpr char kStateMagic[] = "haptic_cloth state\n";

/// Makes sure that a state may be written there: a new file in a directory that can be written, or one that
/// holds a state or nothing. @throws InputError naming the file
void checkStateFile(const std::string& file);

/// Writes what Simulation::saveState() gave, under a temporary name that is renamed when all of it is on the
/// disk: whatever happens, the file holds its old content or all of the new.
/// @throws InputError as checkStateFile()  @throws std::runtime_error naming the file and what went wrong
void writeStateFile(const std::string& file, const std::string& state);

/// @throws InputError naming a file that cannot be read
std::string readStateFile(const std::string& file);

}  // namespace haptic_cloth
