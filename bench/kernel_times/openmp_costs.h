/// What OpenMP itself takes, after the method of [M04]: a delay in a region, less the delay alone.
#pragma once

namespace haptic_cloth {

/// Some nanoseconds of work that no compiler leaves out.
void delay();

/// `regions` parallel regions, one after the other, each thread of each with one delay.
void forkAndJoin(int threads, int regions);

/// The same with a loop shared out evenly, as the library's loops are.
void shareLoops(int threads, int loops);

/// One region with so many barriers, a delay before each.
void meetAtBarriers(int threads, int barriers);

}  // namespace haptic_cloth
