#include "contact/sample_forces.h"

#include "contact/friction_law.h"
#include "simd/kernels.h"

namespace haptic_cloth {

SampleForces::SampleForces(const SolidSet& solids, const SampleList& samples, const ContactLaw& law,
                           double slip)
    : solids_(solids), samples_(samples), law_(law), slip_(slip) {}

void SampleForces::reserve(int samples) {
  packs_.reserve(samples / kPack + 1);
  for (Field* field : {&gradient_, &change_}) field->reserve(samples);
}

void SampleForces::rebuild() {
  packs_.assign(samples_.size() / kPack, SamplePack{});
  for (int k = 0; k < samples_.size(); ++k) {
    const ContactSample& sample = samples_[k];
    const Vec3 start = slipOrigin(sample);
    SamplePack& pack = packs_[k / kPack];
    const int l = k % kPack;
    pack.at_nodes = (l == 0 || pack.at_nodes) && sample.weights[0] == 1.0;
    for (int c = 0; c < 4; ++c) {
      pack.nodes[c].index[l] = sample.nodes[c];
      pack.weights[c][l] = sample.weights[c];
    }
    for (int c = 0; c < 3; ++c) {
      pack.start[c][l] = start[c];
      pack.start_normal[c][l] = sample.start_normal[c];
    }
    pack.area[l] = sample.area;
    pack.gap_offset[l] = sample.count.offset;
    pack.firmest_gap[l] = sample.count.firmest;
    pack.friction[l] = sample.friction_force;
    pack.clearance[l] = sample.area > 0.0 ? sample.clearance : 1e150;
  }
  for (SamplePack& pack : packs_) {
    for (PackIndices& nodes : pack.nodes) nodes.finish();
  }
  // Each evaluation writes all entries.
  for (Field* field : {&gradient_, &change_}) field->resize(samples_.size());
}

SampleContext SampleForces::context(int solid) const {
  const Vec3 from = solids_.origin(solid);
  return {solids_[solid].lanes(),  turnOf(solid), {from.x(), from.y(), from.z()},
          !solids_.isProbe(solid), law_.range(),  slip_};
}

SolidMotion SampleForces::motion(int solid, const Proxies& d_proxies) const {
  const auto [shift, spin] = solids_.motion(solid, d_proxies);
  const bool spins = !spin.isZero(0.0);
  return {{shift.x(), shift.y(), shift.z()},
          {spin.x(), spin.y(), spin.z()},
          spins,
          spins ? turnOf(solid) : TurnLanes()};
}

TurnLanes SampleForces::turnOf(int solid) const {
  const Mat3 turned = solids_.turned(solid);
  TurnLanes turn{turned != Mat3::Identity(), {}};
  Eigen::Map<Eigen::Matrix<double, 3, 3, Eigen::RowMajor>>(turn.rotation) = turned;
  return turn;
}

/// Calls visit(solid, first pack, last pack) for each group's part of samples begin..end.
template <class Visit>
void SampleForces::forGroups(int begin, int end, const Visit& visit) const {
  for (const SampleList::Group& group : samples_.groups()) {
    const int first = std::max(group.begin, begin / kPack), last = std::min(group.end, end / kPack);
    if (first < last) visit(group.solid, first, last);
  }
}

ContactEnergy SampleForces::evaluate(int begin, int end, const Field& nodes) {
  ContactEnergy energy;
  forGroups(begin, end, [&](int solid, int first, int last) {
    const ContactEnergy part = kernels().evaluateSamples(packs_.data(), first, last, context(solid),
                                                         nodes.arrays(), gradient_.arrays(), kPack * first);
    energy.contact += part.contact;
    energy.friction += part.friction;
  });
  return energy;
}

double SampleForces::quadraticForm(int begin, int end, const Field& d, const Proxies& d_proxies,
                                   bool whole_motion) const {
  double sum = 0.0;
  forGroups(begin, end, [&](int solid, int first, int last) {
    sum += kernels().sampleQuadraticForm(packs_.data(), first, last, d.arrays(), motion(solid, d_proxies),
                                         slip_, whole_motion && solids_.isProbe(solid));
  });
  return sum;
}

double SampleForces::maxStep(const Field& d, const Proxies& d_proxies) const {
  // The distance is convex, so its tangent bounds it along a straight way, and nearly so along the short arc
  // of a turn. A probe that is pressed hard goes below the firm gap, where the law is linear: there all
  // directions would end at next to nothing.
  constexpr double kShareOfGap = 0.9;
  double step = 1e300;
  forGroups(0, samples_.size(), [&](int solid, int first, int last) {
    if (!solids_.isProbe(solid)) return;
    step = std::min(step, kernels().largestStep(packs_.data(), first, last, kShareOfGap, law_.firmGap(),
                                                d.arrays(), motion(solid, d_proxies)));
  });
  return step;
}

void SampleForces::linearise(int begin, int end, const Field& nodes, const Field& d,
                             const Proxies& d_proxies) {
  // The change of the normal is a central difference: solids have flat faces, round edges and
  // corners. The difference is taken over a length far below any radius.
  constexpr double kNudge = 1e-7;  // [m]
  for (int k = begin; k < end; ++k) {
    const ContactSample& sample = samples_[k];
    const SamplePack& pack = this->pack(k);
    const int l = k % kPack;
    change_.set(k, Vec3::Zero());
    if (pack.normal_stiffness[l] == 0.0 && pack.tangent_stiffness[l] == 0.0) continue;
    const Vec3 position = sample.of(nodes);
    const Vec3 moved = sample.of(d) - solids_.motion(sample.solid, d_proxies).position;
    const Solid& solid = solids_[sample.solid];
    change_.set(k, pack.normal_stiffness[l] * normal(k).dot(moved) * normal(k));
    const double length = moved.norm();
    if (!(length > 0.0)) continue;
    const Vec3 nudge = kNudge / length * moved;
    change_.add(k, -pack.pressing[l] * length / (2.0 * kNudge) *
                       (solid.distance(position + nudge).normal - solid.distance(position - nudge).normal));
    if (sample.friction_force > 0.0)
      change_.add(
          k, product(frictionBlock(laneOf(pack.slip, l), sample.start_normal, sample.friction_force, slip_),
                     moved));
  }
}

Vec3 SampleForces::friction(int sample) const {
  const int l = sample % kPack;
  return pack(sample).tangent_stiffness[l] * laneOf(pack(sample).slip, l);
}

Vec3 SampleForces::torque(int sample, const Vec3& lever) const {
  const Vec3 friction = this->friction(sample);
  return lever.cross(gradient_[sample] - friction) + slipLever(sample).cross(friction);
}

Vec3 SampleForces::slipLever(int sample) const {
  return solids_.turned(samples_[sample].solid) * slipOrigin(samples_[sample]);
}

Vec3 SampleForces::normal(int sample) const { return laneOf(pack(sample).normal, sample % kPack); }

Block SampleForces::block(int sample) const {
  const SamplePack& pack = this->pack(sample);
  const int l = sample % kPack;
  Block block = pack.normal_stiffness[l] * square(normal(sample));
  if (pack.tangent_stiffness[l] > 0.0)
    block += frictionBlock(laneOf(pack.slip, l), samples_[sample].start_normal, pack.friction[l], slip_);
  return block;
}

}  // namespace haptic_cloth
