/// The files `simulate` writes. Formats: docs/formats.md.
#pragma once

#include <filesystem>
#include <string>

#include "haptic_cloth/simulation.h"
#include "tools/run.h"

namespace haptic_cloth {

/// Creates the directory if need be and makes sure that files can be written there.
/// @throws InputError naming the directory
void prepareDirectory(const std::filesystem::path& directory);

/// Writes summary.json, steps.csv, probe.csv, particles.csv and mesh.ply. Each file is written under a
/// temporary name and renamed when complete, so a reader never sees half a file.
/// @param succeeded what summary.json says of the run
/// @throws std::runtime_error naming the file that could not be written
void writeOutputs(const std::filesystem::path& directory, const Simulation& simulation,
                  const RunRecord& record, bool succeeded);

}  // namespace haptic_cloth
