/// A loop with a data race, run in parallel like every loop of the solver. The thread sanitizer
/// must report it, and ends the program there; otherwise its silence about the other programs proves
/// nothing. The loop is repeated, because the first thread takes the part of a second one that is late.
#include <chrono>

#include "parallel/parallel_for.h"

int main() {
  using Clock = std::chrono::steady_clock;
  const auto until = Clock::now() + std::chrono::seconds(60);
  haptic_cloth::Team team(2);
  long sum = 0;
  team.run(1000, [&] {
    while (Clock::now() < until) {
      team.forRange(1000, [&](int begin, int end) {
        for (int k = begin; k < end; ++k) sum += k;
      });
    }
  });
  return sum == 0 ? 1 : 0;
}
