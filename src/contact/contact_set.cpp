#include "contact/contact_set.h"

#include <algorithm>
#include <cmath>

namespace haptic_cloth {
namespace {

/// Sets the flags of the nodes that a sample acts on to 1.
void markNodes(const ContactSample& sample, std::vector<char>& nodes) {
  for (int c = 0; c < 4; ++c) {
    if (sample.weights[c] > 0.0) nodes[sample.nodes[c]] = 1;
  }
}

}  // namespace

ContactSet::ContactSet(const Grid& grid, const std::vector<Obstacle>& obstacles,
                       const std::vector<ProbeOptions>& probes, const Options& options, Team& team)
    : slip_speed_(options.slip_speed),
      time_step_(options.time_step),
      grid_(grid),
      law_(options.range),
      solids_(obstacles, probes, options.range),
      memory_(grid),
      finder_(grid, solids_, law_, memory_, team),
      forces_(solids_, samples_, law_, options.slip_speed * options.time_step) {
  const int capacity = finder_.capacity();
  samples_.reserve(capacity, 2 * solids_.size());
  forces_.reserve(capacity);
  memory_.reserve(capacity);
  gather_.reserve(grid.particles(), capacity);
  if (options.self) self_.emplace(grid, *options.self, options.slip_speed * options.time_step);
}

void ContactSet::advance(double time_step, const Field& nodes) {
  time_step_ = time_step;
  forces_.setSlip(slip_speed_ * time_step);
  if (self_) self_->setSlip(slip_speed_ * time_step);
  solids_.advance(nodes);
}

void ContactSet::collectObstacles(const ActiveMesh& mesh, const Field& nodes,
                                  const std::vector<double>& reach, const Field& motion) {
  finder_.findObstacles(mesh, nodes, reach, motion, samples_);
  forces_.rebuild();
  gather_.rebuild(samples_, mesh.nodes());
}

bool ContactSet::maySink(const ActiveMesh& mesh, const Field& nodes, const Cell& cell, double moved) const {
  constexpr double kSinks = 0.5;  // [ranges of the law]
  if (moved <= kSinks * law_.range()) return false;
  const int half = cell.span() / 2;
  for (int k = 0; k < obstacles(); ++k) {
    for (const int j : {cell.j, cell.j + half, cell.j + cell.span()}) {
      for (const int i : {cell.i, cell.i + half, cell.i + cell.span()}) {
        const int n = mesh.node[grid_.particle(i, j)];
        if (n >= 0 && obstacle(k).distance(nodes[n]).value < law_.range() + moved) return true;
      }
    }
  }
  return false;
}

ContactSet::Energy ContactSet::evaluate(int begin, int end, const Field& nodes) {
  const int samples = samples_.size();
  const ContactEnergy solids = forces_.evaluate(std::min(begin, samples), std::min(end, samples), nodes);
  if (!self_ || end <= samples) return {solids.contact, 0.0, solids.friction};
  const ContactEnergy layers = self_->evaluate(std::max(begin, samples) - samples, end - samples, nodes);
  return {solids.contact, layers.contact, solids.friction + layers.friction};
}

bool ContactSet::carry(const Field& x, Field& ways) const {
  constexpr double kLeastWay = 0.5;  // [ranges of the law]
  int fastest = -1;
  double longest = kLeastWay * law_.range();
  for (int k = 0; k < solids_.obstacles(); ++k) {
    if (!(solids_.pathLength(k) > longest)) continue;
    fastest = k;
    longest = solids_.pathLength(k);
  }
  if (fastest < 0) return false;
  ways.resize(x.size());
  for (int n = 0; n < x.size(); ++n) ways.set(n, solids_.carried(fastest, x[n]));
  return true;
}

double ContactSet::quadraticForm(int begin, int end, const Field& d, const Proxies& d_proxies,
                                 bool whole_motion) const {
  const int samples = samples_.size();
  const double sum =
      forces_.quadraticForm(std::min(begin, samples), std::min(end, samples), d, d_proxies, whole_motion);
  if (!self_ || end <= samples) return sum;
  return sum + self_->quadraticForm(std::max(begin, samples) - samples, end - samples, d);
}

void ContactSet::serialize(Archive& archive) {
  solids_.serialize(archive);
  memory_.serialize(archive, solids_.size());
  finder_.serialize(archive);
  // Cloth that passes through itself remembers nothing there, but has the same entries: the format of a
  // state does not depend on self-contact.
  struct NoLayers {
    FrictionMemory memory;
    void serialize(Archive& entries) { memory.serialize(entries, SelfContact::kFaces); }
  } none{FrictionMemory(grid_)};
  self_ ? archive("layers", *self_) : archive("layers", none);
}

void ContactSet::rememberFriction(const ActiveMesh& mesh, const ConstArrays& normals) {
  if (self_) self_->rememberFriction(mesh, normals);
  memory_.clear();
  for (int k = 0; k < samples_.size(); ++k) {
    const ContactSample& sample = samples_[k];
    if (!(sample.friction_force > 0.0) || !forces_.touches(k)) continue;
    const double half = 0.5 * std::sqrt(sample.area / (grid_.dx * grid_.dy));
    memory_.add(sample.solid, sample.flat, half, forces_.friction(k) / sample.area);
  }
}

void ContactSet::appendAwake(const std::vector<char>& awake, int first, Runs& runs) const {
  for (int k = 0; k < samples_.size(); k += kPack) {
    bool wanted = solids_.isProbe(samples_[k].solid);
    for (int l = 0; l < kPack; ++l) {
      for (const int node : samples_[k + l].nodes) wanted = wanted || awake[node] != 0;
    }
    if (wanted) runs.add(first + k, first + k + kPack);
  }
  if (self_) self_->appendAwake(awake, first + samples_.size(), runs);
}

void ContactSet::addDiagonal(Field& diagonal) const {
  for (int n = 0; n < diagonal.size(); ++n) {
    gather_.forSamples(n, [&](int sample, double weight) {
      diagonal.add(n, weight * weight * forces_.block(sample).head<3>());
    });
  }
  if (self_) self_->addDiagonal(diagonal);
}

/// Calls visit(k) for the samples of a probe, or of the obstacles.
template <class Visit>
void ContactSet::forSamples(int probe, const Visit& visit) const {
  for (const SampleList::Group& group : samples_.groups()) {
    const int solid = group.solid;
    if (probe == kObstacles ? solids_.isProbe(solid) : solid != solids_.indexOf(probe)) continue;
    for (int k = kPack * group.begin; k < kPack * group.end; ++k) visit(k);
  }
}

void ContactSet::addSprings(int probe, Blocks& blocks) const {
  forSamples(probe, [&](int k) {
    const Block own = forces_.block(k);
    if (own.isZero(0.0)) return;
    const ContactSample& sample = samples_[k];
    for (int c = 0; c < 4; ++c) {
      if (sample.weights[c] > 0.0) blocks[sample.nodes[c]] += sample.weights[c] * own;
    }
  });
}

Vec3 ContactSet::proxyGradient(int probe) const {
  Vec3 sum = Vec3::Zero();
  forSamples(probe, [&](int k) { sum -= forces_.gradient()[k]; });
  return sum;
}

Vec3 ContactSet::proxyTorque(int probe, const Field& nodes) const {
  const Vec3& proxy = solids_[solids_.indexOf(probe)].position();
  Vec3 sum = Vec3::Zero();
  forSamples(probe, [&](int k) { sum += forces_.torque(k, samples_[k].of(nodes) - proxy); });
  return sum;
}

Vec3 ContactSet::proxyDiagonal(int probe) const {
  Vec3 sum = Vec3::Zero();
  forSamples(probe, [&](int k) { sum += forces_.block(k).head<3>(); });
  return sum;
}

Vec3 ContactSet::turnDiagonal(int probe) const {
  Vec3 sum = Vec3::Zero();
  forSamples(probe, [&](int k) { sum += aroundArm(forces_.block(k), forces_.slipLever(k)).diagonal(); });
  return sum;
}

Vec3 ContactSet::proxyChange(int probe) const {
  Vec3 sum = Vec3::Zero();
  forSamples(probe, [&](int k) { sum -= forces_.change()[k]; });
  return sum;
}

Block ContactSet::stiffness() const {
  Block sum = Block::Zero();
  for (int k = 0; k < samples_.size(); ++k) sum += forces_.block(k);
  return sum;
}

Vec3 ContactSet::obstacleForce() const {
  Vec3 sum = Vec3::Zero();
  forSamples(kObstacles, [&](int k) { sum -= forces_.gradient()[k]; });
  return sum;
}

double ContactSet::workOfSolids() const {
  double work = 0.0;
  for (const SampleList::Group& group : samples_.groups()) {
    if (solids_.isStill(group.solid)) continue;
    const Eigen::AngleAxisd turn = solids_.turnInStep(group.solid);
    for (int k = kPack * group.begin; k < kPack * group.end; ++k) {
      const ContactSample& sample = samples_[k];
      work -= sample.carry.dot(partOf(turn, 0.5 - sample.turn_share) * forces_.gradient()[k]);
    }
  }
  return work;
}

double ContactSet::ejectionWork() const {
  double work = 0.0;
  forSamples(kObstacles, [&](int k) {
    const ContactSample& sample = samples_[k];
    const double gap = forces_.gap(k);
    if (sample.pressed_in || (sample.count.offset == 0.0 && !(gap < 0.0))) return;
    const auto energy = [&](const ContactLaw::Count& count) {
      return law_(gap + count.offset, count.firmest).energy;
    };
    work += sample.area * (energy(law_.count(gap, false)) - energy(sample.count));
  });
  return work;
}

double ContactSet::deepest() const {
  double deepest = 0.0;
  for (int k = 0; k < samples_.size(); ++k) deepest = std::max(deepest, -forces_.gap(k));
  return deepest;
}

void ContactSet::markEjected(std::vector<char>& nodes) const {
  for (const ContactSample& sample : samples_) {
    if (sample.count.offset == 0.0) continue;
    for (const int node : sample.nodes) nodes[node] = 1;
  }
}

void ContactSet::markListed(std::vector<char>& nodes) const {
  if (self_) self_->markListed(nodes);
  for (const ContactSample& sample : samples_) {
    if (sample.area > 0.0) markNodes(sample, nodes);
  }
}

bool ContactSet::markCarried(std::vector<char>& nodes) const {
  bool any = false;
  for (const SampleList::Group& group : samples_.groups()) {
    if (solids_.isProbe(group.solid) || solids_.isStill(group.solid)) continue;
    for (int k = kPack * group.begin; k < kPack * group.end; ++k) {
      if (!forces_.touches(k)) continue;
      any = true;
      markNodes(samples_[k], nodes);
    }
  }
  return any;
}

void ContactSet::touchedNodes(int probe, std::vector<int>& nodes) const {
  forSamples(probe, [&](int k) {
    if (forces_.touches(k)) nodes.insert(nodes.end(), samples_[k].nodes.begin(), samples_[k].nodes.end());
  });
}

bool ContactSet::probeTouched(int probe) const {
  bool touched = false;
  forSamples(probe, [&](int k) { touched = touched || forces_.touches(k); });
  return touched;
}

}  // namespace haptic_cloth
