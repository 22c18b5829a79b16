#include "sim/multilevel_preconditioner.h"

#include <algorithm>

namespace haptic_cloth {
namespace {

// Hats of several levels move the same parts of the cloth: in full, their sum goes too far. Twice their
// blocks needs the fewest iterations (docs/design.md).
constexpr double kOverlap = 2.0;

constexpr double kHat = 1e-8;  // about what a hat or a child takes one core [s]

/// Adds a share of ghosts' blocks to their masters', which leaves none to the ghosts.
void handOver(const ActiveMesh& mesh, double share, Blocks& blocks) {
  mesh.handOverGhosts(blocks, share);
  std::fill(blocks.begin() + mesh.active(), blocks.begin() + mesh.nodes(), Block::Zero());
}

}  // namespace

MultilevelPreconditioner::MultilevelPreconditioner(const ActiveMesh& mesh, int probes, Team& team)
    : mesh_(mesh), team_(team), hats_(mesh) {
  const int particles = mesh.grid.particles();
  for (Blocks* list : {&between_, &points_}) list->reserve(hats_.pointCapacity());
  for (Blocks* list : {&node_inverse_, &touch_}) list->reserve(particles);
  hat_inverse_.reserve(hats_.hatCapacity());
  springs_.reserve(particles);
  proxies_.reserve(probes);
  values_.reserve(hats_.pointCapacity());
  corrections_.reserve(hats_.hatCapacity());
}

void MultilevelPreconditioner::resize() { hats_.rebuild(mesh_); }

void MultilevelPreconditioner::fit(const InternalEnergy& internal, const ContactSet& contacts, double inertia,
                                   const std::vector<char>& awake, const std::vector<HeldNode>& held,
                                   const std::vector<ProxyUnknown>& proxies) {
  for (Blocks* list : {&between_, &points_}) list->assign(hats_.points(), Block::Zero());
  internal.addBlocks(between_);
  handOver(mesh_, 0.25, between_);
  addContacts(contacts, proxies);
  for (int n = 0; n < mesh_.nodes(); ++n) points_[n] += isotropic(inertia * mesh_.mass[n]);
  invertNodes(awake, held);
  for (Proxy& proxy : proxies_) bind(proxy);
  invertHats();
}

void MultilevelPreconditioner::addContacts(const ContactSet& contacts,
                                           const std::vector<ProxyUnknown>& proxies) {
  contacts.addSprings(ContactSet::kObstacles, points_);
  handOver(mesh_, 0.5, points_);
  springs_.clear();
  proxies_.clear();
  for (const ProxyUnknown& unknown : proxies) {
    Proxy proxy{unknown.probe, unknown.at, static_cast<int>(springs_.size()), 0,
                isotropic(unknown.stiffness)};
    touch_.assign(mesh_.nodes(), Block::Zero());
    contacts.addSprings(unknown.probe, touch_);
    handOver(mesh_, 0.5, touch_);
    for (int n = 0; n < mesh_.free; ++n) {
      if (touch_[n].isZero(0.0)) continue;
      points_[n] += touch_[n];
      springs_.push_back({n, touch_[n]});
    }
    proxy.springs_end = static_cast<int>(springs_.size());
    proxies_.push_back(proxy);
  }
}

/// What a proxy holds counts as its own.
void MultilevelPreconditioner::invertNodes(const std::vector<char>& awake,
                                           const std::vector<HeldNode>& held) {
  node_inverse_.resize(mesh_.free);
  for (int n = 0; n < mesh_.free; ++n) {
    node_inverse_[n] = awake[n] ? inverse(between_[n] + points_[n]) : Block(Block::Zero());
  }
  for (const HeldNode& node : held) {
    node_inverse_[node.node].setZero();
    for (Proxy& proxy : proxies_) {
      if (proxy.probe == node.probe) proxy.inverse += between_[node.node] + points_[node.node];
    }
  }
}

/// The proxy's block with its nodes eliminated.
void MultilevelPreconditioner::bind(Proxy& proxy) const {
  for (int k = proxy.springs; k < proxy.springs_end; ++k) {
    const Spring& spring = springs_[k];
    // S - S D⁻¹ S, symmetric as S and D are.
    const Mat3 s = matrix(spring.stiffness);
    proxy.inverse += block(s - s * matrix(node_inverse_[spring.node]) * s);
  }
  proxy.inverse = inverse(proxy.inverse);
}

void MultilevelPreconditioner::invertHats() {
  hat_inverse_.resize(hats_.hats().size());
  for (const HatLevels::Level& level : hats_.levels()) {
    for (int hat = level.hats; hat < level.hats_end; ++hat) {
      const int point = hats_.hats()[hat];
      between_[point] = (between_[point] + hats_.sumOfChildren(hat, between_)) / (1.0 + hats_.shares(hat));
      points_[point] += hats_.sumOfChildren(hat, points_);
      const bool held = point >= mesh_.free && point < mesh_.active();
      hat_inverse_[hat] =
          held ? Block(Block::Zero()) : inverse(kOverlap * (between_[point] + points_[point]));
    }
  }
}

void MultilevelPreconditioner::apply(const Vector& gradient, Vector& z) {
  values_.assign(hats_.points(), Vec3::Zero());
  for (int n = 0; n < mesh_.free; ++n) values_[n] = entry(gradient, n);
  applyHats();
  team_.forRange(
      mesh_.free, [&](int begin, int end) { applyNodes(gradient, z, begin, end); }, Team::kNode);
  for (const Proxy& proxy : proxies_) applyProxy(proxy, gradient, z);
}

/// Of the gradient in values_, all hats' part of the direction, there too.
void MultilevelPreconditioner::applyHats() {
  corrections_.resize(hats_.hats().size());
  for (const HatLevels::Level& level : hats_.levels()) {
    const auto restrict = [&](int begin, int end) {
      for (int hat = level.hats + begin; hat < level.hats + end; ++hat) {
        Vec3& value = values_[hats_.hats()[hat]];
        value += hats_.sumOfChildren(hat, values_);
        corrections_[hat] = product(hat_inverse_[hat], value);
      }
    };
    team_.forRange(level.hats_end - level.hats, restrict, kHat);
  }
  std::fill(values_.begin(), values_.end(), Vec3::Zero());
  for (auto level = hats_.levels().rbegin(); level != hats_.levels().rend(); ++level) {
    for (int hat = level->hats; hat < level->hats_end; ++hat) values_[hats_.hats()[hat]] += corrections_[hat];
    const auto interpolate = [&](int begin, int end) {
      for (int k = level->children + begin; k < level->children + end; ++k) {
        const HatLevels::Child& child = hats_.children()[k];
        const auto& p = child.parents;
        values_[child.point] =
            HatLevels::kShare * (values_[p[0]] + values_[p[1]] + values_[p[2]] + values_[p[3]]);
      }
    };
    team_.forRange(level->children_end - level->children, interpolate, kHat);
  }
}

void MultilevelPreconditioner::applyNodes(const Vector& gradient, Vector& z, int begin, int end) const {
  for (int n = begin; n < end; ++n) {
    const Block& own = node_inverse_[n];
    const bool moves = own[0] > 0.0;
    const Vec3 value = moves ? Vec3(values_[n] + product(own, entry(gradient, n))) : Vec3(Vec3::Zero());
    for (int c = 0; c < 3; ++c) z[c * mesh_.free + n] = value[c];
  }
}

/// Forward over the nodes it touches, the proxy, and back.
void MultilevelPreconditioner::applyProxy(const Proxy& proxy, const Vector& gradient, Vector& z) const {
  Vec3 force = gradient.segment<3>(proxy.at);
  for (int k = proxy.springs; k < proxy.springs_end; ++k) {
    const Spring& spring = springs_[k];
    force += product(spring.stiffness, product(node_inverse_[spring.node], entry(gradient, spring.node)));
  }
  const Vec3 moved = product(proxy.inverse, force);
  z.segment<3>(proxy.at) = moved;
  for (int k = proxy.springs; k < proxy.springs_end; ++k) {
    const Spring& spring = springs_[k];
    const Vec3 follows = product(node_inverse_[spring.node], product(spring.stiffness, moved));
    for (int c = 0; c < 3; ++c) z[c * mesh_.free + spring.node] += follows[c];
  }
}

}  // namespace haptic_cloth
