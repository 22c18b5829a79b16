// Part of ContactSet that evaluates the samples.
#include <algorithm>

#include "contact/contact_set.h"
#include "simd/kernels.h"

namespace haptic_cloth {

void ContactSet::packGroup(const Group& group) {
  for (int k = kPack * group.begin; k < kPack * group.end; ++k) {
    const ContactSample& sample = samples_[k];
    SamplePack& pack = packs_[k / kPack];
    const int l = k % kPack;
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
    for (PackIndices& nodes : packs_[p].nodes) nodes.finish();
  }
}

SampleContext ContactSet::context(const Group& group) const {
  const Vec3 from = origin(group.solid);
  return {solids_[group.solid].lanes(),
          {from.x(), from.y(), from.z()},
          !isProbe(group.solid),
          law_.range(),
          options_.slip_speed * options_.time_step};
}

/// Calls visit(group, first pack, last pack) for each group's part of samples begin..end.
template <class Visit>
void ContactSet::forGroups(int begin, int end, const Visit& visit) const {
  for (const Group& group : groups_) {
    const int first = std::max(group.begin, begin / kPack), last = std::min(group.end, end / kPack);
    if (first < last) visit(group, first, last);
  }
}

void ContactSet::appendAwake(const std::vector<char>& awake, int first, Runs& runs) const {
  for (int k = 0; k < size(); k += kPack) {
    bool wanted = isProbe(samples_[k].solid);
    for (int l = 0; l < kPack; ++l) {
      for (const int node : samples_[k + l].nodes) wanted = wanted || awake[node] != 0;
    }
    if (wanted) runs.add(first + k, first + k + kPack);
  }
}

ContactSet::Energy ContactSet::evaluate(int begin, int end, const Field& nodes) {
  Energy energy;
  forGroups(begin, end, [&](const Group& group, int first, int last) {
    const Energy part = kernels().evaluateSamples(packs_.data(), first, last, context(group), nodes.arrays(),
                                                  gradient_.arrays(), kPack * first);
    energy.contact += part.contact;
    energy.friction += part.friction;
  });
  return energy;
}

double ContactSet::curvature(int begin, int end, const Field& d, const std::vector<Vec3>& d_proxies,
                             bool whole_way) const {
  double sum = 0.0;
  forGroups(begin, end, [&](const Group& group, int first, int last) {
    const Vec3 moved = motionOf(group.solid, d_proxies);
    sum += kernels().sampleCurvature(packs_.data(), first, last, d.arrays(), moved.data(),
                                     whole_way && isProbe(group.solid));
  });
  return sum;
}

double ContactSet::maxStep(const Field& d, const std::vector<Vec3>& d_proxies) const {
  // The distance is convex, so its tangent bounds it along the step.
  constexpr double kShareOfGap = 0.9;
  double step = 1e300;
  forGroups(0, size(), [&](const Group& group, int first, int last) {
    if (!isProbe(group.solid)) return;
    const Vec3 moved = motionOf(group.solid, d_proxies);
    step = std::min(step,
                    kernels().largestStep(packs_.data(), first, last, kShareOfGap, d.arrays(), moved.data()));
  });
  return step;
}

void ContactSet::addGradient(int begin, int end, Field& gradient) const {
  for (int n = begin; n < end; ++n) {
    if (rows_[n] == rows_[n + 1]) continue;
    Vec3 sum = gradient[n];
    for (int e = rows_[n]; e < rows_[n + 1]; ++e) sum += entries_[e].weight * gradient_[entries_[e].sample];
    gradient.set(n, sum);
  }
}

Vec3 ContactSet::normal(int sample) const {
  const SamplePack& pack = packs_[sample / kPack];
  const int l = sample % kPack;
  return {pack.normal[0][l], pack.normal[1][l], pack.normal[2][l]};
}

/// Block of H⁺ by the position of a sample [N/m].
Block ContactSet::blockOf(int sample) const {
  const SamplePack& pack = packs_[sample / kPack];
  const double across = pack.normal_stiffness[sample % kPack], along = pack.tangent_stiffness[sample % kPack];
  if (across == 0.0 && along == 0.0) return Block::Zero();
  return across * square(normal(sample)) + along * (isotropic(1.0) - square(samples_[sample].start_normal));
}

void ContactSet::addDiagonal(Field& diagonal) const {
  for (int n = 0; n < diagonal.size(); ++n) {
    for (int e = rows_[n]; e < rows_[n + 1]; ++e) {
      diagonal.add(n, entries_[e].weight * entries_[e].weight * blockOf(entries_[e].sample).head<3>());
    }
  }
}

void ContactSet::addSprings(int probe, Blocks& blocks) const {
  for (const Group& group : groups_) {
    const bool wanted = probe == kObstacles ? !isProbe(group.solid) : group.solid == obstacles_ + probe;
    if (!wanted) continue;
    for (int k = kPack * group.begin; k < kPack * group.end; ++k) {
      const Block own = blockOf(k);
      if (own.isZero(0.0)) continue;
      const ContactSample& sample = samples_[k];
      for (int c = 0; c < 4; ++c) {
        if (sample.weights[c] > 0.0) blocks[sample.nodes[c]] += sample.weights[c] * own;
      }
    }
  }
}

/// Sums a value over the samples of a probe.
template <class Value>
Vec3 ContactSet::sumOf(int probe, const Value& value) const {
  Vec3 sum = Vec3::Zero();
  for (const Group& group : groups_) {
    if (group.solid != obstacles_ + probe) continue;
    for (int k = kPack * group.begin; k < kPack * group.end; ++k) sum += value(k);
  }
  return sum;
}

Vec3 ContactSet::proxyGradient(int probe) const {
  return sumOf(probe, [this](int k) { return Vec3(-gradient_[k]); });
}

Vec3 ContactSet::proxyTorque(int probe, const Field& nodes) const {
  const Vec3& proxy = solids_[obstacles_ + probe].position();
  return sumOf(probe, [&](int k) { return Vec3((at(samples_[k], nodes) - proxy).cross(gradient_[k])); });
}

Vec3 ContactSet::proxyDiagonal(int probe) const {
  return sumOf(probe, [this](int k) { return Vec3(blockOf(k).head<3>()); });
}

Vec3 ContactSet::proxyChange(int probe) const {
  return sumOf(probe, [this](int k) { return Vec3(-change_[k]); });
}

Vec3 ContactSet::obstacleForce() const {
  Vec3 sum = Vec3::Zero();
  for (int k = 0; k < size(); ++k) {
    if (!isProbe(samples_[k].solid)) sum -= gradient_[k];
  }
  return sum;
}

double ContactSet::obstacleWork() const {
  double work = 0.0;
  for (int k = 0; k < size(); ++k) {
    if (!isProbe(samples_[k].solid)) work -= gradient_[k].dot(samples_[k].carry);
  }
  return work;
}

double ContactSet::letOutWork() const {
  double work = 0.0;
  for (int k = 0; k < size(); ++k) {
    const ContactSample& sample = samples_[k];
    const double gap = packs_[k / kPack].gap[k % kPack];
    if (isProbe(sample.solid) || (sample.raised == 0.0 && !(gap < 0.0))) continue;
    work += sample.area * (law_(gap + raise(sample.solid, gap)).energy - law_(gap + sample.raised).energy);
  }
  return work;
}

double ContactSet::deepest() const {
  double deepest = 0.0;
  for (int k = 0; k < size(); ++k) deepest = std::max(deepest, -packs_[k / kPack].gap[k % kPack]);
  return deepest;
}

void ContactSet::calm(Field& velocities) const {
  for (const ContactSample& sample : samples_) {
    if (sample.raised == 0.0) continue;
    for (const int node : sample.nodes) velocities.set(node, Vec3::Zero());
  }
}

void ContactSet::markLetOut(std::vector<char>& nodes) const {
  for (const ContactSample& sample : samples_) {
    if (sample.raised == 0.0) continue;
    for (const int node : sample.nodes) nodes[node] = 1;
  }
}

void ContactSet::touchedNodes(int probe, std::vector<int>& nodes) const {
  for (const Group& group : groups_) {
    if (group.solid != obstacles_ + probe) continue;
    for (int k = kPack * group.begin; k < kPack * group.end; ++k) {
      if (!(packs_[k / kPack].normal_stiffness[k % kPack] > 0.0)) continue;
      nodes.insert(nodes.end(), samples_[k].nodes.begin(), samples_[k].nodes.end());
    }
  }
}

bool ContactSet::probeTouched(int probe) const {
  for (const Group& group : groups_) {
    if (group.solid != obstacles_ + probe) continue;
    for (int k = kPack * group.begin; k < kPack * group.end; ++k) {
      if (packs_[k / kPack].normal_stiffness[k % kPack] > 0.0) return true;
    }
  }
  return false;
}

/// Limits the motion of obstacles: none may pass through the cloth within a step. An obstacle that
/// is sent farther lags behind.
void ContactSet::advance() {
  constexpr double kShareOfWidth = 0.25;
  for (int k = 0; k < obstacles_; ++k) {
    Solid& solid = solids_[k];
    before_[k] = solid;
    const Pose& target = targets_[k];
    const Quat turned(solid.rotation());
    const double way = (target.position - solid.position()).norm() +
                       solid.extent() * turned.angularDistance(target.orientation);
    if (!(way > 0.0)) continue;
    const double share = std::min(1.0, kShareOfWidth * solid.halfWidth() / way);
    if (share < 1.0) {
      solid.place(solid.position() + share * (target.position - solid.position()));
      solid.turn(turned.slerp(share, target.orientation));
    } else {
      solid.place(target.position);
      solid.turn(target.orientation);
    }
  }
}

double ContactSet::obstacleSpeed(int k) const {
  const Solid &now = solids_[k], &then = before_[k];
  if (now.position() == then.position() && now.rotation() == then.rotation()) return 0.0;
  const double turned = Quat(now.rotation()).angularDistance(Quat(then.rotation()));
  return ((now.position() - then.position()).norm() + now.extent() * turned) / options_.time_step;
}

bool ContactSet::obstaclesMove() const {
  for (int k = 0; k < obstacles_; ++k) {
    const Eigen::Matrix3d target = targets_[k].orientation.toRotationMatrix();
    const auto moves = [&](const Solid& solid) {
      return solid.position() != targets_[k].position || solid.rotation() != target;
    };
    if (moves(solids_[k]) || moves(before_[k])) return true;
  }
  return false;
}

}  // namespace haptic_cloth
