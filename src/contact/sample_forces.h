/// Energy, forces and stiffness of contact samples: pressure and friction.
#pragma once

#include <vector>

#include "contact/contact_law.h"
#include "contact/sample_list.h"
#include "contact/sample_packs.h"
#include "contact/solid_set.h"
#include "mesh/block.h"
#include "mesh/field.h"

namespace haptic_cloth {

/// Evaluates samples in packs (sample_packs.h) and keeps the results of the last evaluation. Ranges
/// begin..end of samples are multiples of kPack.
class SampleForces {
 public:
  /// @param slip slip in a step below which friction is smoothed [m]
  SampleForces(const SolidSet& solids, const SampleList& samples, const ContactLaw& law, double slip);

  void reserve(int samples);
  void setSlip(double slip) { slip_ = slip; }  ///< see the constructor [m]

  /// Adapts to new samples.
  void rebuild();

  /// Evaluates samples begin..end, and stores their forces and stiffness. @return their energy
  ContactEnergy evaluate(int begin, int end, const Field& nodes);

  /// Quadratic form d · H⁺ d of samples begin..end at the last evaluation.
  /// @param d_proxies directions of all probes
  /// @param whole_motion friction of probes as over the whole of d, even if its beginning is stiffer
  double quadraticForm(int begin, int end, const Field& d, const Proxies& d_proxies, bool whole_motion) const;

  /// Largest factor of d from the last evaluated point at which no probe sample uses up more than
  /// 0.9 of its gap.
  double maxStep(const Field& d, const Proxies& d_proxies) const;

  /// Stores how the gradient of each sample changes along d at `nodes`, the last evaluated point.
  /// The change includes the curvature of the solids. @pre no solid turns along d
  void linearise(int begin, int end, const Field& nodes, const Field& d, const Proxies& d_proxies);

  /// Energy gradient by the samples' positions, and its change along a direction [N].
  const Field& gradient() const { return gradient_; }
  const Field& change() const { return change_; }

  /// Results for one sample: its gap [m], and its block of H⁺ [N/m].
  double gap(int sample) const { return pack(sample).gap[sample % kPack]; }
  Block block(int sample) const;
  /// Friction of a sample at the last evaluation [N].
  Vec3 friction(int sample) const;
  /// Torque of a sample on its solid about the solid's origin at the last evaluation [N·m]: minus the change
  /// of its energy as the solid turns. Friction acts where the slip counts from.
  /// @param lever its place from the origin [m]
  Vec3 torque(int sample, const Vec3& lever) const;
  /// Where the slip of a sample counts from, as its solid has turned, from the solid's origin [m].
  Vec3 slipLever(int sample) const;
  bool touches(int sample) const { return pack(sample).normal_stiffness[sample % kPack] > 0.0; }

 private:
  const SamplePack& pack(int sample) const { return packs_[sample / kPack]; }
  Vec3 normal(int sample) const;
  Vec3 slipOrigin(const ContactSample& sample) const { return sample.start - slip_ * sample.elastic_slip; }
  SampleContext context(int solid) const;
  SolidMotion motion(int solid, const Proxies& d_proxies) const;
  TurnLanes turnOf(int solid) const;
  template <class Visit>
  void forGroups(int begin, int end, const Visit& visit) const;

  const SolidSet& solids_;
  const SampleList& samples_;
  ContactLaw law_;
  double slip_;  ///< [m]
  std::vector<SamplePack> packs_;
  Field gradient_, change_;
};

}  // namespace haptic_cloth
