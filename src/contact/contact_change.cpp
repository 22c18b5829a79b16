// Part of ContactSet that computes the change of contact forces along a direction.
#include "contact/contact_set.h"

namespace haptic_cloth {

void ContactSet::linearise(int begin, int end, const Field& nodes, const Field& d,
                           const std::vector<Vec3>& d_proxies) {
  // The change of the normal is a central difference: solids have flat faces, round edges and
  // corners. The difference is taken over a length far below any radius.
  constexpr double kNudge = 1e-7;  // [m]
  const double epsilon = options_.slip_speed * options_.time_step;
  for (int k = begin; k < end; ++k) {
    const ContactSample& sample = samples_[k];
    const SamplePack& pack = packs_[k / kPack];
    const int l = k % kPack;
    change_.set(k, Vec3::Zero());
    if (pack.normal_stiffness[l] == 0.0 && pack.tangent_stiffness[l] == 0.0) continue;
    const Vec3 position = at(sample, nodes);
    const Vec3 moved = at(sample, d) - motionOf(sample.solid, d_proxies);
    const Solid& solid = solids_[sample.solid];
    change_.set(k, pack.normal_stiffness[l] * normal(k).dot(moved) * normal(k));
    const double length = moved.norm();
    if (!(length > 0.0)) continue;
    const Vec3 nudge = kNudge / length * moved;
    change_.add(k, -pack.pressing[l] * length / (2.0 * kNudge) *
                       (solid.distance(position + nudge).normal - solid.distance(position - nudge).normal));
    if (sample.friction_force > 0.0) {
      const auto along = [&](const Vec3& v) {
        return Vec3(v - sample.start_normal.dot(v) * sample.start_normal);
      };
      const Vec3 slip = along(position - origin(sample.solid) - sample.start), slipping = along(moved);
      const double fading = sample.friction_force * smoothSlip(slip.norm(), epsilon).slope;
      change_.add(k, pack.tangent_stiffness[l] * slipping + fading * slip.dot(slipping) * slip);
    }
  }
}

void ContactSet::addChange(int begin, int end, Field& change) const {
  for (int n = begin; n < end; ++n) {
    for (int e = rows_[n]; e < rows_[n + 1]; ++e) {
      change.add(n, entries_[e].weight * change_[entries_[e].sample]);
    }
  }
}

}  // namespace haptic_cloth
