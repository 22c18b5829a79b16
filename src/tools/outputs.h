/// The files `simulate` writes. Formats: docs/reference/results.md.
#pragma once

#include <filesystem>

#include "haptic_cloth/simulation.h"
#include "state/new_file.h"
#include "tools/run.h"

namespace haptic_cloth {

/// Creates the directory if need be and makes sure that the files of a scene can be written there.
/// @param state_file to be written, too, so none of these; empty: none
/// @throws InputError naming the directory or the file
void prepareDirectory(const std::filesystem::path& directory, const Scene& scene,
                      const std::filesystem::path& state_file);

/// Writes summary.json, steps.csv, probe.csv, particles.csv and mesh.ply, all of which get their
/// names with files.publish(), summary.json last.
/// @param succeeded what summary.json says of the run
/// @throws OutputError naming the file that cannot be written
void writeOutputs(const std::filesystem::path& directory, const Simulation& simulation,
                  const RunRecord& record, bool succeeded, NewFiles& files);

}  // namespace haptic_cloth
