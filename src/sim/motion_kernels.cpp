#include "sim/motion.h"
#include "simd/kernels.h"
#include "simd/lanes.h"

namespace haptic_cloth {
namespace HAPTIC_CLOTH_PATH {

double evaluateMotion(const Motion& motion, int begin, int end, const ConstArrays& x,
                      const MutableArrays& gradient) {
  const Lanes3 gravity{all(motion.gravity[0]), all(motion.gravity[1]), all(motion.gravity[2])};
  Lanes energy{};
  for (int n = begin; n < end; n += kLanes) {
    const Lanes3 now = load(x, n), ahead = now - load(motion.inertial, n);
    const Lanes mass = load(motion.mass + n), stiffness = motion.inertia * load(motion.moving_mass + n);
    energy += 0.5 * stiffness * dot(ahead, ahead) - mass * dot(gravity, now - load(motion.start, n));
    store(gradient, n, stiffness * ahead - mass * gravity);
  }
  return total(energy);
}

double motionQuadraticForm(const Motion& motion, int begin, int end, const ConstArrays& d) {
  Lanes sum{};
  for (int n = begin; n < end; n += kLanes) {
    const Lanes3 change = load(d, n);
    sum += load(motion.moving_mass + n) * dot(change, change);
  }
  return motion.inertia * total(sum);
}

}  // namespace HAPTIC_CLOTH_PATH
}  // namespace haptic_cloth
