/// A loop with a data race, run in parallel like every loop of the solver. The thread sanitizer
/// must report it; otherwise its silence about the other programs proves nothing.
#include "parallel/parallel_for.h"

int main() {
  haptic_cloth::Team team(2);
  long sum = 0;
  team.run(100000, [&] {
    team.forRange(100000, [&](int begin, int end) {
      for (int k = begin; k < end; ++k) sum += k;
    });
  });
  return sum == 0 ? 1 : 0;
}
