/// Contact samples of a step.
#pragma once

#include <array>
#include <vector>

#include "contact/contact_law.h"
#include "contact/friction_memory.h"
#include "haptic_cloth/types.h"
#include "mesh/field.h"
#include "simd/pack.h"

namespace haptic_cloth {

/// Point of the cloth's surface, within a cell or at a node.
struct SurfacePoint {
  std::array<int, 4> nodes;       ///< corners of its cell
  std::array<double, 4> weights;  ///< bilinear weights, sum 1
  double area;                    ///< area of cloth that it stands for [m²]
  FlatPoint flat;                 ///< where it is in the flat cloth

  static SurfacePoint atNode(int node, double area, const FlatPoint& flat = {}) {
    return {{node, node, node, node}, {1.0, 0.0, 0.0, 0.0}, area, flat};
  }

  /// Value at this point. @param values values at all nodes
  Vec3 of(const Field& values) const {
    return weights[0] * values[nodes[0]] + weights[1] * values[nodes[1]] + weights[2] * values[nodes[2]] +
           weights[3] * values[nodes[3]];
  }
};

/// Point of the surface that may touch one solid in this step.
struct ContactSample : SurfacePoint {
  int solid = 0;                                       ///< index in SolidSet
  bool pressed_in = false;                             ///< if it is inside the solid, a load pressed it there
  ContactLaw::Count count{0.0, ContactLaw::kNoLimit};  ///< other if it began the step inside a solid
  /// Gap at the start of the step beyond the range of contact [m].
  double clearance = 0.0;
  double friction_force = 0.0;  ///< μ times the normal force at the start of the step [N]
  /// Position if the solid carries it along; for a probe relative to the proxy [m].
  Vec3 start = Vec3::Zero();
  Vec3 carry = Vec3::Zero();  ///< displacement to that position from the start of the step [m]
  double turn_share = 0.0;    ///< share of its solid's turn that it is expected to make in the step
  Vec3 start_normal = Vec3::Zero();
  /// Slip that the friction at the start of the step stands for, over the length below which friction
  /// is smoothed: at most 1 [-].
  Vec3 elastic_slip = Vec3::Zero();

  /// Tells whether it was put inside an obstacle, which lets it out.
  bool isLetOut() const { return !pressed_in && count.offset != 0.0; }
};

/// Samples in groups: each belongs to one solid and fills whole packs, the last with samples that
/// have no area and so no effect.
class SampleList {
 public:
  struct Group {
    int solid, begin, end;  ///< begin, end: packs
  };

  void reserve(int samples, int groups) {
    samples_.reserve(samples);
    groups_.reserve(groups);
  }
  void clear() {
    samples_.clear();
    groups_.clear();
  }

  void beginGroup(int solid) { groups_.push_back({solid, size() / kPack, 0}); }
  void add(const ContactSample& sample) { samples_.push_back(sample); }
  void endGroup() {
    Group& group = groups_.back();
    while (size() % kPack != 0) add(ContactSample{SurfacePoint::atNode(0, 0.0), group.solid});
    group.end = size() / kPack;
  }

  int size() const { return static_cast<int>(samples_.size()); }
  int capacity() const { return static_cast<int>(samples_.capacity()); }
  const ContactSample& operator[](int sample) const { return samples_[sample]; }
  auto begin() const { return samples_.begin(); }
  auto end() const { return samples_.end(); }
  const std::vector<Group>& groups() const { return groups_; }

 private:
  std::vector<ContactSample> samples_;
  std::vector<Group> groups_;
};

}  // namespace haptic_cloth
