// OpenMP is measured here, not used. In the library only parallel_for.h uses it.
#include "openmp_costs.h"

namespace haptic_cloth {
namespace {

constexpr int kDelay = 50;  // dependent steps, each with two additions and a division

}  // namespace

void delay() {
  volatile double sum = 0.0;
  double chain = 0.0;
  for (int k = 0; k < kDelay; ++k) chain += 1.0 / (1.0 + chain);
  sum = chain;
  (void)sum;
}

#ifdef _OPENMP

void forkAndJoin(int threads, int regions) {
  for (int k = 0; k < regions; ++k) {
#pragma omp parallel num_threads(threads)
    delay();
  }
}

void shareLoops(int threads, int loops) {
  for (int k = 0; k < loops; ++k) {
#pragma omp parallel for schedule(static) num_threads(threads)
    for (int part = 0; part < threads; ++part) delay();
  }
}

void meetAtBarriers(int threads, int barriers) {
#pragma omp parallel num_threads(threads)
  for (int k = 0; k < barriers; ++k) {
    delay();
#pragma omp barrier
  }
}

#else

void forkAndJoin(int, int regions) {
  for (int k = 0; k < regions; ++k) delay();
}
void shareLoops(int threads, int loops) {
  for (int k = 0; k < threads * loops; ++k) delay();
}
void meetAtBarriers(int, int barriers) {
  for (int k = 0; k < barriers; ++k) delay();
}

#endif

}  // namespace haptic_cloth
