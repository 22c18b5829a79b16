/// Costs of OpenMP itself, measured as in [M04]: a delay in a region, minus the delay alone.
#pragma once

namespace haptic_cloth {

/// A short delay that no compiler removes.
void delay();

/// Runs `regions` parallel regions, one after the other, with one delay per thread.
void forkAndJoin(int threads, int regions);

/// The same with a loop divided evenly, as the library's loops are.
void shareLoops(int threads, int loops);

/// Runs one region with as many barriers, and a delay before each.
void meetAtBarriers(int threads, int barriers);

}  // namespace haptic_cloth
