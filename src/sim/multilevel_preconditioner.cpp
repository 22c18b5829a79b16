#include "sim/multilevel_preconditioner.h"

#include <algorithm>

#include "sim/node_entry.h"
#include "simd/kernels.h"

namespace haptic_cloth {
namespace {

// Hat functions of several levels move the same parts of the cloth, so the plain sum of their
// corrections is too large. Doubling their blocks needs the fewest iterations (decision 0006).
constexpr double kOverlap = 2.0;

// Approximate times on one core [s]: for a hat or child, for a node's own block, for an inverse.
constexpr double kHat = 4e-9, kOwn = 2e-9, kInverse = 2e-8;

/// Adds half of the block of each hanging node to its masters, then clears the blocks of hanging
/// nodes.
void handOver(const ActiveMesh& mesh, Blocks& blocks) {
  mesh.handOverGhosts(blocks);
  std::fill(blocks.begin() + mesh.active(), blocks.begin() + mesh.nodes(), Block::Zero());
}

}  // namespace

MultilevelPreconditioner::MultilevelPreconditioner(const ActiveMesh& mesh, int probes, Team& team)
    : mesh_(mesh), team_(team), hats_(mesh), binding_(mesh) {
  const int particles = mesh.grid.particles();
  for (Blocks* list : {&between_, &points_}) list->reserve(hats_.pointCapacity());
  for (BlockField& field : elements_) field.reserve(particles);
  node_inverse_.reserve(particles);
  for (Blocks* list : {&touch_, &layers_}) list->reserve(particles);
  hat_inverse_.reserve(hats_.hatCapacity());
  springs_.reserve(particles);
  bodies_.reserve(probes);
  values_.reserve(hats_.pointCapacity());
  corrections_.reserve(hats_.hatCapacity());
}

void MultilevelPreconditioner::resize() { hats_.rebuild(mesh_); }

void MultilevelPreconditioner::fit(const InternalEnergy& internal, const ContactSet& contacts,
                                   const TimeIntegrator& integrator, const std::vector<char>& awake,
                                   const Field& nodes, const std::vector<HeldNode>& held,
                                   const std::vector<ProxyUnknown>& proxies, bool binds_layers) {
  for (Blocks* list : {&between_, &points_}) list->assign(hats_.points(), Block::Zero());
  addElements(internal);
  addContacts(contacts, nodes, proxies);
  addLayers(contacts);
  for (int n = 0; n < mesh_.nodes(); ++n) points_[n] += isotropic(integrator.inertia(n) * mesh_.mass[n]);
  invertNodes(awake, held);
  for (Body& body : bodies_) bind(body);
  binding_.clear();
  if (binds_layers && contacts.self())
    binding_.fit(*contacts.self(), between_, points_, node_inverse_, nodes);
  for (int n = 0; n < mesh_.active(); ++n) points_[n] += layers_[n];
  invertHats();
}

void MultilevelPreconditioner::addElements(const InternalEnergy& internal) {
  // Depends on size alone, because the bits of the result depend on it.
  const int parts = mesh_.nodes() < kWorthParts ? 1 : kParts;
  team_.forTasks(parts, [&](int part) {
    elements_[part].clear(mesh_.nodes());
    internal.addBlocks(part, parts, elements_[part]);
  });
  const auto sum = [&](int begin, int end) {
    for (int part = 1; part < parts; ++part) {
      for (int k = 0; k < 6; ++k) {
        auto &total = elements_[0].entry(k), &more = elements_[part].entry(k);
        for (int n = begin; n < end; ++n) total[n] += more[n];
      }
    }
  };
  team_.forRange(mesh_.nodes(), sum, kOwn);
  for (int k = 0; k < 6; ++k) mesh_.handOverGhosts(elements_[0].entry(k), 0.25);
  const auto copy = [&](int begin, int end) {
    for (int n = begin; n < end; ++n) between_[n] = elements_[0][n];
  };
  team_.forRange(mesh_.active(), copy, kOwn);
}

void MultilevelPreconditioner::addContacts(const ContactSet& contacts, const Field& nodes,
                                           const std::vector<ProxyUnknown>& proxies) {
  contacts.addSprings(ContactSet::kObstacles, points_);
  handOver(mesh_, points_);
  springs_.clear();
  bodies_.clear();
  for (const ProxyUnknown& unknown : proxies) {
    Body body{unknown.probe, unknown.at, unknown.turns ? 6 : 3, static_cast<int>(springs_.size()), 0, {}, {}};
    body.coupling << Vec3::Constant(unknown.stiffness), Vec3::Constant(unknown.turn_stiffness);
    body.inverse = body.coupling.asDiagonal();
    touch_.assign(mesh_.nodes(), Block::Zero());
    contacts.addSprings(unknown.probe, touch_);
    handOver(mesh_, touch_);
    for (int n = 0; n < mesh_.free; ++n) {
      if (touch_[n].isZero(0.0)) continue;
      points_[n] += touch_[n];
      springs_.push_back({n, touch_[n], unknown.turns ? Vec3(nodes[n] - unknown.position) : Vec3::Zero()});
    }
    body.springs_end = static_cast<int>(springs_.size());
    bodies_.push_back(body);
  }
}

void MultilevelPreconditioner::addLayers(const ContactSet& contacts) {
  layers_.assign(mesh_.nodes(), Block::Zero());
  if (contacts.self()) contacts.self()->addSprings(layers_);
  handOver(mesh_, layers_);
}

/// Inverts the nodes' blocks. Held nodes get zero; their stiffness is added to that of the proxy.
void MultilevelPreconditioner::invertNodes(const std::vector<char>& awake,
                                           const std::vector<HeldNode>& held) {
  node_inverse_.resize(mesh_.free);
  const auto invert = [&](int begin, int end) {
    for (int n = begin; n < end; ++n) {
      node_inverse_.set(n, awake[n] ? inverse(ofNode(n)) : Block(Block::Zero()));
    }
  };
  team_.forRange(mesh_.free, invert, kInverse);
  for (const HeldNode& node : held) {
    node_inverse_.set(node.node, Block::Zero());
    for (Body& body : bodies_) {
      if (body.probe != node.probe) continue;
      addSpring(ofNode(node.node), body.unknowns == 6 ? node.offset : Vec3::Zero(), body.inverse);
    }
  }
}

/// Adds the stiffness of a spring at the end of an arm to that against shifts and turns.
void MultilevelPreconditioner::addSpring(const Block& stiffness, const Vec3& arm, BodyMatrix& sum) {
  const Mat3 s = matrix(stiffness), cross = crossMatrix(arm), coupled = s * cross;
  sum.topLeftCorner<3, 3>() += s;
  sum.topRightCorner<3, 3>() -= coupled;
  sum.bottomLeftCorner<3, 3>() -= coupled.transpose();
  sum.bottomRightCorner<3, 3>() += aroundArm(stiffness, arm);
}

/// Eliminates the touched nodes from the block of the proxy and inverts it.
void MultilevelPreconditioner::bind(Body& body) const {
  for (int k = body.springs; k < body.springs_end; ++k) {
    const Spring& spring = springs_[k];
    // The Schur complement S - S D⁻¹ S is symmetric, like S and D.
    const Mat3 s = matrix(spring.stiffness);
    addSpring(block(s - s * matrix(node_inverse_[spring.node]) * s), spring.arm, body.inverse);
  }
  const Eigen::LLT<BodyMatrix> factors(body.inverse);
  // By rounding it may be indefinite. Then the proxy moves as if it touched nothing.
  if (factors.info() == Eigen::Success) {
    body.inverse = factors.solve(BodyMatrix::Identity());
  } else {
    body.inverse = body.coupling.cwiseInverse().asDiagonal();
  }
}

void MultilevelPreconditioner::invertHats() {
  hat_inverse_.resize(hats_.hats().size());
  for (const HatLevels::Level& level : hats_.levels()) {
    const auto invert = [&](int begin, int end) {
      for (int k = level.hats + begin; k < level.hats + end; ++k) invertHat(k, level.doublesBoth());
    };
    team_.forRange(level.hats_end - level.hats, invert, kInverse);
  }
}

/// @param square whether the lattice below the hat is narrower in both directions
void MultilevelPreconditioner::invertHat(int k, bool square) {
  const HatLevels::Hat& hat = hats_.hats()[k];
  const int point = hat.point;
  hats_.gatherChildren(hat, between_.data());
  hats_.gatherChildren(hat, points_.data());
  // The mean of what it covers. Twice as long and no wider, edges have half of their stiffness.
  between_[point] /= (square ? 1.0 : 2.0) * (1.0 + hat.shares);
  const bool held = point >= mesh_.free && point < mesh_.active();
  const Block own = held ? Block(Block::Zero()) : inverse(kOverlap * (between_[point] + points_[point]));
  hat_inverse_[k] << matrix(own).cast<float>(), Eigen::RowVector3f::Zero();
}

void MultilevelPreconditioner::apply(const Vector& gradient, Vector& z) {
  values_.resize(hats_.points());
  team_.forRange(
      mesh_.free,
      [&](int begin, int end) {
        kernels().loadPoints(gradient.data(), mesh_.free, begin, end, values_.data()->data());
      },
      kOwn);
  std::fill(values_.begin() + mesh_.free, values_.end(), HatValue::Zero());
  applyHats();
  const BlockArrays own = node_inverse_.arrays();
  team_.forRange(
      mesh_.free,
      [&](int begin, int end) {
        kernels().addOwnBlocks(own, gradient.data(), values_.data()->data(), mesh_.free, begin, end,
                               z.data());
      },
      kOwn);
  for (const Body& body : bodies_) applyBody(body, gradient, z);
  binding_.apply(node_inverse_, gradient, z);
}

/// Replaces the gradient in values_ by the sum of the corrections of all hats. Values that children
/// gave to their parents are no longer needed; they are overwritten on the way back.
void MultilevelPreconditioner::applyHats() {
  corrections_.resize(hats_.hats().size());
  HatValue* const values = values_.data();
  for (const HatLevels::Level& level : hats_.levels()) {
    const auto restrict = [&, values](int begin, int end) {
      for (int k = level.hats + begin; k < level.hats + end; ++k) {
        const HatLevels::Hat& hat = hats_.hats()[k];
        hats_.gatherChildren(hat, values);
        corrections_[k] = hat_inverse_[k].lazyProduct(values[hat.point].head<3>());
      }
    };
    team_.forRange(level.hats_end - level.hats, restrict, kHat);
  }
  for (const int top : hats_.tops()) values[top].setZero();
  for (auto level = hats_.levels().rbegin(); level != hats_.levels().rend(); ++level) {
    const auto add = [&](int begin, int end) {
      for (int k = level->hats + begin; k < level->hats + end; ++k)
        values[hats_.hats()[k].point] += corrections_[k];
    };
    team_.forRange(level->hats_end - level->hats, add, kHat);
    const auto interpolate = [&](int begin, int end) { hats_.interpolate(*level, begin, end, values); };
    team_.forRange(level->children_end - level->children, interpolate, kHat);
  }
}

/// Solves for a proxy and the nodes that it touches: forward over the nodes, the proxy, and back.
void MultilevelPreconditioner::applyBody(const Body& body, const Vector& gradient, Vector& z) const {
  Eigen::Matrix<double, 6, 1> force = Eigen::Matrix<double, 6, 1>::Zero();
  force.head(body.unknowns) = gradient.segment(body.at, body.unknowns);
  for (int k = body.springs; k < body.springs_end; ++k) {
    const Spring& spring = springs_[k];
    const Vec3 pushes = product(
        spring.stiffness, product(node_inverse_[spring.node], entryOf(gradient, mesh_.free, spring.node)));
    force.head<3>() += pushes;
    force.tail<3>() += spring.arm.cross(pushes);
  }
  const Eigen::Matrix<double, 6, 1> moved = body.inverse * force;
  z.segment(body.at, body.unknowns) = moved.head(body.unknowns);
  for (int k = body.springs; k < body.springs_end; ++k) {
    const Spring& spring = springs_[k];
    const Vec3 there = moved.head<3>() + moved.tail<3>().cross(spring.arm);
    const Vec3 follows = product(node_inverse_[spring.node], product(spring.stiffness, there));
    addEntry(z, mesh_.free, spring.node, follows);
  }
}

}  // namespace haptic_cloth
