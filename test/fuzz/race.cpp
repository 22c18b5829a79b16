/// A loop with a race, shared out like every loop of the solver: the thread sanitizer must see it, or its
/// silence about the rest says nothing.
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
