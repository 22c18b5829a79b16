/// Result of a run, for programs (JSON) and for people.
#pragma once

#include <string>

#include "haptic_cloth/simulation.h"
#include "tools/run.h"

namespace haptic_cloth {

/// The text of summary.json; SI units, doubles in the shortest form that reads back to the same bits.
/// @param succeeded value of the key `succeeded`
std::string summaryJson(const Simulation& simulation, const RunTotals& totals, bool succeeded);

/// Simulated over wall time of this run [-]; 0 before its first step.
double realTimeFactor(const Simulation& simulation, const RunTotals& totals);

/// The run in a few lines for a person.
std::string briefReport(const Simulation& simulation, const RunTotals& totals);

}  // namespace haptic_cloth
