// The part of ContactSet that evaluates the samples.
#include <algorithm>

#include "contact/contact_set.h"

namespace haptic_cloth {

void ContactSet::packGroup(const Group& group) {
  for (int k = kLanes * group.begin; k < kLanes * group.end; ++k) {
    const ContactSample& sample = samples_[k];
    SamplePack& pack = packs_[k / kLanes];
    const int l = k % kLanes;
    pack.at_nodes = (l == 0 || pack.at_nodes) && sample.weights[0] == 1.0;
    for (int c = 0; c < 4; ++c) {
      pack.nodes[c].index[l] = sample.nodes[c];
      pack.weights[c][l] = sample.weights[c];
    }
    for (int c = 0; c < 3; ++c) {
      pack.start[c][l] = sample.start[c];
      pack.start_normal[c][l] = sample.start_normal[c];
    }
    pack.area[l] = sample.area;
    pack.raised[l] = sample.raised;
    pack.friction[l] = sample.friction_force;
    pack.clearance[l] = sample.area > 0.0 ? sample.clearance : 1e150;
  }
  for (int p = group.begin; p < group.end; ++p) {
    for (NodeLanes& nodes : packs_[p].nodes) nodes.finish();
  }
}

SampleContext ContactSet::context(const Group& group, const Vec3& proxy) const {
  const bool probe = group.solid == kProbe;
  SampleContext context{{}, {0.0, 0.0, 0.0}, !probe, law_, options_.slip_speed * options_.time_step};
  if (probe) {
    context.solid.shape = Shape::Sphere;
    context.solid.radius = options_.probe_radius;
    for (int c = 0; c < 3; ++c) context.solid.position[c] = context.origin[c] = proxy[c];
  } else {
    context.solid = obstacles_[group.solid].lanes();
  }
  return context;
}

/// Calls visit(group, first pack, last pack) for the parts of samples begin..end.
template <class Visit>
void ContactSet::forGroups(int begin, int end, const Visit& visit) const {
  for (const Group& group : groups_) {
    const int first = std::max(group.begin, begin / kLanes), last = std::min(group.end, end / kLanes);
    if (first < last) visit(group, first, last);
  }
}

void ContactSet::appendAwake(const std::vector<char>& awake, int first, Runs& runs) const {
  for (int k = 0; k < size(); k += kLanes) {
    bool wanted = samples_[k].solid == kProbe;
    for (int l = 0; l < kLanes; ++l) {
      for (const int node : samples_[k + l].nodes) wanted = wanted || awake[node] != 0;
    }
    if (wanted) runs.add(first + k, first + k + kLanes);
  }
}

ContactSet::Energy ContactSet::evaluate(int begin, int end, const Field& nodes, const Vec3& proxy) {
  Energy energy;
  forGroups(begin, end, [&](const Group& group, int first, int last) {
    const Energy part = evaluateSamples(packs_.data(), first, last, context(group, proxy), nodes.arrays(),
                                        gradient_.arrays(), kLanes * first);
    energy.contact += part.contact;
    energy.friction += part.friction;
  });
  return energy;
}

double ContactSet::curvature(int begin, int end, const Field& d, const Vec3& d_proxy) const {
  double sum = 0.0;
  forGroups(begin, end, [&](const Group& group, int first, int last) {
    const Vec3 moved = group.solid == kProbe ? d_proxy : Vec3::Zero();
    sum += sampleCurvature(packs_.data(), first, last, d.arrays(), moved.data());
  });
  return sum;
}

double ContactSet::maxStep(const Field& d, const Vec3& d_proxy) const {
  constexpr double kShareOfGap = 0.9;  // the distance is convex: its tangent bounds it along the step
  double step = 1e300;
  forGroups(0, size(), [&](const Group& group, int first, int last) {
    if (group.solid != kProbe) return;
    step = std::min(step, largestStep(packs_.data(), first, last, kShareOfGap, d.arrays(), d_proxy.data()));
  });
  return step;
}

void ContactSet::addGradient(int begin, int end, Field& gradient) const {
  for (int n = begin; n < end; ++n) {
    for (int e = rows_[n]; e < rows_[n + 1]; ++e) {
      gradient.add(n, entries_[e].weight * gradient_[entries_[e].sample]);
    }
  }
}

Vec3 ContactSet::normal(int sample) const {
  const SamplePack& pack = packs_[sample / kLanes];
  const int l = sample % kLanes;
  return {pack.normal[0][l], pack.normal[1][l], pack.normal[2][l]};
}

/// Of H⁺ by the sample's position [N/m].
Vec3 ContactSet::diagonalOf(int sample) const {
  const SamplePack& pack = packs_[sample / kLanes];
  const int l = sample % kLanes;
  if (pack.normal_stiffness[l] == 0.0 && pack.tangent_stiffness[l] == 0.0) return Vec3::Zero();
  return pack.normal_stiffness[l] * normal(sample).cwiseAbs2() +
         pack.tangent_stiffness[l] * (Vec3::Ones() - samples_[sample].start_normal.cwiseAbs2());
}

void ContactSet::addDiagonal(Field& diagonal) const {
  for (int n = 0; n < diagonal.size(); ++n) {
    for (int e = rows_[n]; e < rows_[n + 1]; ++e) {
      diagonal.add(n, entries_[e].weight * entries_[e].weight * diagonalOf(entries_[e].sample));
    }
  }
}

Vec3 ContactSet::proxyGradient() const {
  Vec3 sum = Vec3::Zero();
  for (int k = 0; k < size(); ++k) {
    if (samples_[k].solid == kProbe) sum -= gradient_[k];
  }
  return sum;
}

Vec3 ContactSet::proxyDiagonal() const {
  Vec3 sum = Vec3::Zero();
  for (int k = 0; k < size(); ++k) {
    if (samples_[k].solid == kProbe) sum += diagonalOf(k);
  }
  return sum;
}

Vec3 ContactSet::obstacleForce() const {
  Vec3 sum = Vec3::Zero();
  for (int k = 0; k < size(); ++k) {
    if (samples_[k].solid != kProbe) sum -= gradient_[k];
  }
  return sum;
}

double ContactSet::deepest() const {
  double deepest = 0.0;
  for (int k = 0; k < size(); ++k) deepest = std::max(deepest, -packs_[k / kLanes].gap[k % kLanes]);
  return deepest;
}

void ContactSet::calm(Field& velocities) const {
  for (const ContactSample& sample : samples_) {
    if (sample.raised == 0.0) continue;
    for (const int node : sample.nodes) velocities.set(node, Vec3::Zero());
  }
}

bool ContactSet::probeTouched() const {
  for (int k = 0; k < size(); ++k) {
    if (samples_[k].solid == kProbe && packs_[k / kLanes].normal_stiffness[k % kLanes] > 0.0) return true;
  }
  return false;
}

}  // namespace haptic_cloth
