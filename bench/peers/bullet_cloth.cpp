/// bullet_cloth: the scene's cloth with Bullet's soft bodies.
///   --solver soft         btSoftBody in btSoftRigidDynamicsWorld: position based links with a
///                         stiffness in [0, 1]
///   --solver deformable   btDeformableMultiBodyDynamicsWorld: backward Euler on linear springs
/// Both have only links: bending is a spring between every other particle of a thread. The cloth meets
/// itself by one convex cluster for each triangle (soft) or by particles and triangles (deformable).
#include <BulletSoftBody/btDeformableBodySolver.h>
#include <BulletSoftBody/btDeformableGravityForce.h>
#include <BulletSoftBody/btDeformableMassSpringForce.h>
#include <BulletSoftBody/btDeformableMultiBodyConstraintSolver.h>
#include <BulletSoftBody/btDeformableMultiBodyDynamicsWorld.h>
#include <BulletSoftBody/btSoftBody.h>
#include <BulletSoftBody/btSoftBodyInternals.h>
#include <BulletSoftBody/btSoftBodyRigidBodyCollisionConfiguration.h>
#include <BulletSoftBody/btSoftRigidDynamicsWorld.h>
#include <btBulletDynamicsCommon.h>

#include <algorithm>
#include <cmath>
#include <new>

#include "haptic_cloth/error.h"
#include "peer.h"

namespace haptic_cloth {
namespace peers {
namespace {

// [kg]; as much as about 10⁵ particles, so its velocity shows the impulse on it
constexpr double kProbeMass = 10.0;
constexpr int kHashSize = 65537;  // size of the hash table of grid cells
constexpr double kVoxel = 0.004;  // largest spacing of the grid of a solid's distances [m]
// Values at which secants are taken: strain, angle [rad], curvature [1/m].
constexpr double kStrainOfUse = 0.01, kAngleOfUse = 0.05, kCurvatureOfUse = 100.0;
constexpr double kMostTurn = 1.0;  // [rad]

btVector3 toBullet(const Vec3& v) {
  return {static_cast<btScalar>(v.x()), static_cast<btScalar>(v.y()), static_cast<btScalar>(v.z())};
}
Vec3 fromBullet(const btVector3& v) { return {v.x(), v.y(), v.z()}; }

/// Springs whose stiffness [N/m] is m_kLST of their material; Bullet's own force has only two
/// stiffnesses for all links. Geometric stiffness is omitted under compression, where it would make
/// the matrix indefinite.
class LinkForce : public btDeformableMassSpringForce {
 public:
  LinkForce() : btDeformableMassSpringForce(0, 0, true, 0) {}

  void addScaledForces(btScalar scale, TVStack& force) override { addScaledElasticForce(scale, force); }
  void addScaledDampingForce(btScalar, TVStack&) override {}
  void addScaledDampingForceDifferential(btScalar, const TVStack&, TVStack&) override {}
  void buildDampingForceDifferentialDiagonal(btScalar, TVStack&) override {}

  void addScaledElasticForce(btScalar scale, TVStack& force) override {
    forLinks([&](const btSoftBody::Link& link, int a, int b) {
      const btVector3 d = link.m_n[1]->m_q - link.m_n[0]->m_q;
      const btScalar length = d.length();
      if (!(length > SIMD_EPSILON)) return;
      const btVector3 pull = (scale * link.m_material->m_kLST * (1 - link.m_rl / length)) * d;
      force[a] += pull;
      force[b] -= pull;
    });
  }

  void addScaledElasticForceDifferential(btScalar scale, const TVStack& dx, TVStack& df) override {
    forLinks([&](const btSoftBody::Link& link, int a, int b) {
      const btVector3 d = link.m_n[1]->m_q - link.m_n[0]->m_q;
      const btScalar length = d.length();
      if (!(length > SIMD_EPSILON)) return;
      const btVector3 u = d / length, relative = dx[b] - dx[a];
      const btScalar across = btMax(btScalar(0), 1 - link.m_rl / length);
      const btVector3 change =
          (scale * link.m_material->m_kLST) * (across * relative + ((1 - across) * u.dot(relative)) * u);
      df[a] += change;
      df[b] -= change;
    });
  }

 private:
  template <class Visit>
  void forLinks(const Visit& visit) const {
    for (int i = 0; i < m_softBodies.size(); ++i) {
      const btSoftBody* body = m_softBodies[i];
      for (int k = 0; k < body->m_links.size(); ++k) {
        const btSoftBody::Link& link = body->m_links[k];
        visit(link, link.m_n[0]->index, link.m_n[1]->index);
      }
    }
  }
};

/// Makes two numbers parameters: Newton iterations, and iterations of the linear solver in each.
class DeformableSolver : public btDeformableBodySolver {
 public:
  DeformableSolver(int newton, int linear) {
    m_maxNewtonIterations = newton;
    remake(m_cg, linear);
    remake(m_cr, linear);
  }

 private:
  /// Only the constructors of Bullet's solvers set the number, and they cannot be assigned.
  template <class Krylov>
  static void remake(Krylov& solver, int iterations) {
    solver.~Krylov();
    new (&solver) Krylov(iterations);
  }
};

/// A particle that the probe carries.
struct Held {
  int particle;
  Vec3 offset;    ///< from the probe [m]
  btScalar mass;  ///< when it is free [kg]
};

class BulletCloth : public Peer {
 public:
  BulletCloth(const Scene& scene, const Arguments& arguments)
      : scene_(scene),
        deformable_(arguments.solver == "deformable"),
        iterations_(arguments.iterations > 0 ? arguments.iterations : (deformable_ ? 300 : 10)),
        newton_(arguments.newton > 0 ? arguments.newton : 1),
        h_(arguments.step > 0.0 ? arguments.step : scene.solver.time_step) {
    if (!deformable_ && !arguments.solver.empty() && arguments.solver != "soft") {
      throw InputError("--solver", "", arguments.solver, "must be soft or deformable");
    }
    makeWorld();
    makeCloth();
    for (const Obstacle& obstacle : scene.obstacles) addObstacle(obstacle);
    if (!scene.probes[0].path.empty() && scene.probes[0].grasp.empty()) addProbe();
  }

  double frame() const override { return h_; }

  void step(const Vec3* device, const Vec3& device_velocity) override {
    time_ += h_;
    for (const MovedParticle& moved : moved_) carry(moved.particle, moved.position(time_));
    if (device != nullptr && probe_ == nullptr) moveGrasp(*device);
    moveObstacles();
    if (probe_ != nullptr) {
      btTransform pose(btQuaternion::getIdentity(), toBullet(*device - h_ * device_velocity));
      probe_->setWorldTransform(pose);
      probe_->setInterpolationWorldTransform(pose);
      probe_->setLinearVelocity(toBullet(device_velocity));
      probe_->setInterpolationLinearVelocity(toBullet(device_velocity));
    }
    world_->stepSimulation(static_cast<btScalar>(h_), 0);
    if (deformable_) {
      slowDown();
    } else if (scene_.cloth.self_contact) {
      collideWithItself();
    }
    if (probe_ != nullptr) {
      force_ =
          kProbeMass / h_ * (fromBullet(probe_->getLinearVelocity()) - fromBullet(toBullet(device_velocity)));
      probe_position_ = *device;
    }
  }

  void positions(std::vector<Vec3>& positions) const override {
    positions.resize(cloth_->m_nodes.size());
    for (int n = 0; n < cloth_->m_nodes.size(); ++n) positions[n] = fromBullet(cloth_->m_nodes[n].m_x);
  }

  Vec3 probe() const override { return probe_position_; }
  Vec3 probeForce() const override { return force_; }

  nlohmann::json details() const override {
    return {{"method", deformable_ ? "Bullet deformable" : "Bullet soft body"},
            {"bullet", btGetVersion()},
            {"precision", sizeof(btScalar) == sizeof(double) ? "double" : "single"},
            {"step", h_},
            {"iterations", iterations_},
            {"newton", deformable_ ? newton_ : 0},
            {"links", cloth_->m_links.size()},
            {"most_self_contacts", most_self_contacts_},
            {"bending_spring", bending_spring_}};
  }

 private:
  void makeWorld() {
    broadphase_ = std::make_unique<btDbvtBroadphase>();
    configuration_ = std::make_unique<btSoftBodyRigidBodyCollisionConfiguration>();
    dispatcher_ = std::make_unique<btCollisionDispatcher>(configuration_.get());
    if (deformable_) {
      deformable_solver_ = std::make_unique<DeformableSolver>(newton_, iterations_);
      auto solver = std::make_unique<btDeformableMultiBodyConstraintSolver>();
      solver->setDeformableSolver(deformable_solver_.get());
      auto world = std::make_unique<btDeformableMultiBodyDynamicsWorld>(
          dispatcher_.get(), broadphase_.get(), solver.get(), configuration_.get(), deformable_solver_.get());
      world->setImplicit(true);
      world->setLineSearch(false);
      world->setUseProjection(true);
      world->getSolverInfo().m_deformable_erp = btScalar(0.2);
      world->getSolverInfo().m_deformable_cfm = 0;
      world->getSolverInfo().m_deformable_maxErrorReduction = 200;
      world->getSolverInfo().m_leastSquaresResidualThreshold = btScalar(1e-3);
      world->getSolverInfo().m_splitImpulse = true;
      world->getSolverInfo().m_numIterations = 100;
      info_ = &world->getWorldInfo();
      deformable_world_ = world.get();
      solver_ = std::move(solver);
      world_ = std::move(world);
    } else {
      solver_ = std::make_unique<btSequentialImpulseConstraintSolver>();
      auto world = std::make_unique<btSoftRigidDynamicsWorld>(dispatcher_.get(), broadphase_.get(),
                                                              solver_.get(), configuration_.get());
      info_ = &world->getWorldInfo();
      soft_world_ = world.get();
      world_ = std::move(world);
    }
    world_->setGravity(toBullet(scene_.gravity));
    info_->m_gravity = toBullet(scene_.gravity);
    info_->air_density = info_->water_density = 0;
    info_->m_broadphase = broadphase_.get();
    info_->m_dispatcher = dispatcher_.get();
    info_->m_sparsesdf.Initialize(kHashSize);  // sets the grid spacing to 0.25 m
    info_->m_sparsesdf.setDefaultVoxelsz(static_cast<btScalar>(voxel()));
    info_->m_sparsesdf.Reset();  // applies the new spacing
  }

  /// Spacing of the grid on which Bullet tabulates the solids' distances [m].
  double voxel() const { return std::min(kVoxel, 0.25 * std::min(spacing(kWarp), spacing(kWeft))); }

  /// Bullet rounds edges by a solid's margin and has no distances deeper inside than that. So the
  /// grid points around a particle on the surface must not lie deeper.
  double margin() const { return 2.0 * voxel(); }

  double spacing(int direction) const {
    return scene_.cloth.size[direction] / (scene_.cloth.particles[direction] - 1);
  }

  void makeCloth() {
    const std::vector<Vec3> flat = flatCloth(scene_);
    const std::vector<double> masses = particleMasses(scene_);
    const std::vector<char> pinned = pinnedParticles(scene_);
    const int count = static_cast<int>(flat.size());
    std::vector<btVector3> x(count);
    std::vector<btScalar> m(count);
    for (int p = 0; p < count; ++p) {
      x[p] = toBullet(flat[p]);
      m[p] = pinned[p] ? 0 : static_cast<btScalar>(masses[p]);
    }
    cloth_ = std::make_unique<btSoftBody>(info_, count, x.data(), m.data());
    addLinks();
    addFaces();
    configure();
    if (deformable_) {
      deformable_world_->addSoftBody(cloth_.get());
      forces_.push_back(std::make_unique<LinkForce>());
      forces_.push_back(std::make_unique<btDeformableGravityForce>(toBullet(scene_.gravity)));
      for (const auto& force : forces_) deformable_world_->addForce(cloth_.get(), force.get());
    } else {
      soft_world_->addSoftBody(cloth_.get());
    }
  }

  void configure() {
    const double slowed = 1.0 / (1.0 + scene_.air_damping * h_);
    cloth_->getCollisionShape()->setMargin(static_cast<btScalar>(scene_.cloth.fabric.thickness));
    cloth_->m_cfg.kDP = static_cast<btScalar>(1.0 - slowed);
    cloth_->m_cfg.kDF = 1;
    cloth_->m_cfg.kCHR = cloth_->m_cfg.kKHR = 1;
    cloth_->m_cfg.piterations = iterations_;
    cloth_->m_cfg.collisions = btSoftBody::fCollision::SDF_RS;
    if (deformable_) {
      cloth_->m_cfg.collisions = btSoftBody::fCollision::SDF_RD | btSoftBody::fCollision::SDF_RDN;
    }
    cloth_->setSelfCollision(scene_.cloth.self_contact);
    cloth_->setActivationState(DISABLE_DEACTIVATION);
    if (!scene_.cloth.self_contact) return;
    if (deformable_) {
      cloth_->m_cfg.collisions |= btSoftBody::fCollision::VF_DD;
    } else {
      cloth_->m_cfg.collisions |= btSoftBody::fCollision::CL_SS | btSoftBody::fCollision::CL_SELF;
      cloth_->generateClusters(0);  // one for each triangle
    }
  }

  /// Finds the contacts of the next step. In Bullet 3.24 the flag CL_SELF never takes effect, because it is
  /// part of the mask that selects CL_SS; so its collider is called here.
  void collideWithItself() {
    btSoftColliders::CollideCL_SS collider;
    collider.ProcessSoftSoft(cloth_.get(), cloth_.get());
    most_self_contacts_ = std::max(most_self_contacts_, cloth_->m_joints.size());
  }

  /// Gives a particle without mass the velocity that takes it to its place in one step.
  void carry(int particle, const Vec3& place) {
    btSoftBody::Node& node = cloth_->m_nodes[particle];
    node.m_v = node.m_vn = (toBullet(place) - node.m_x) / static_cast<btScalar>(h_);
  }

  /// A closed probe carries the particles that it touched when it closed; without grasp it would be a solid.
  void moveGrasp(const Vec3& device) {
    const bool closed = grasps(scene_, time_);
    if (!closed) {
      for (const Held& held : held_) cloth_->setMass(held.particle, held.mass);
      held_.clear();
    } else if (held_.empty()) {
      std::vector<Vec3> x;
      positions(x);
      for (int n : touchedParticles(scene_, x, device)) {
        const btScalar mass = cloth_->getMass(n);
        if (mass == 0) continue;
        cloth_->setMass(n, 0);
        held_.push_back({n, x[n] - device, mass});
      }
    }
    for (const Held& held : held_) carry(held.particle, device + held.offset);
    probe_position_ = device;
  }

  void moveObstacles() {
    for (std::size_t k = 0; k < scene_.obstacles.size(); ++k) {
      if (scene_.obstacles[k].path.empty()) continue;
      btTransform pose = bodies_[k]->getWorldTransform();
      pose.setOrigin(toBullet(obstaclePosition(scene_.obstacles[k], time_)));
      bodies_[k]->setWorldTransform(pose);
    }
  }

  /// Applies air damping, which Bullet's deformable world lacks.
  void slowDown() {
    const btScalar slowed = static_cast<btScalar>(1.0 / (1.0 + scene_.air_damping * h_));
    for (int n = 0; n < cloth_->m_nodes.size(); ++n) {
      cloth_->m_nodes[n].m_v *= slowed;
      cloth_->m_nodes[n].m_vn *= slowed;  // start of an implicit step
    }
  }

  int particle(int i, int j) const { return j * scene_.cloth.particles[kWarp] + i; }

  void addFaces() {
    const auto& [columns, rows] = scene_.cloth.particles;
    for (int j = 0; j + 1 < rows; ++j) {
      for (int i = 0; i + 1 < columns; ++i) {
        cloth_->appendFace(particle(i, j), particle(i + 1, j), particle(i + 1, j + 1));
        cloth_->appendFace(particle(i, j), particle(i + 1, j + 1), particle(i, j + 1));
      }
    }
  }

  void addLinks() {
    const auto& [columns, rows] = scene_.cloth.particles;
    for (int direction : {kWarp, kWeft}) {
      const double along = spacing(direction), across = spacing(1 - direction);
      const double tensile = secant(scene_.cloth.fabric.tensile[direction], kStrainOfUse, 0.0);
      const double bend = bendingSpring(direction, along, across);
      for (int j = 0; j < rows; ++j) {
        for (int i = 0; i < columns; ++i) {
          const int left = direction == kWarp ? columns - 1 - i : rows - 1 - j;
          const bool border = direction == kWarp ? j == 0 || j == rows - 1 : i == 0 || i == columns - 1;
          const double share = border ? 0.5 : 1.0;
          const auto ahead = [&](int k) {
            return direction == kWarp ? particle(i + k, j) : particle(i, j + k);
          };
          if (left >= 1) addLink(ahead(0), ahead(1), share * tensile * across / along);
          if (left >= 2) addLink(ahead(0), ahead(2), share * bend);
        }
      }
    }
    const double a = spacing(kWarp), b = spacing(kWeft);
    const double shear =
        secant(scene_.cloth.fabric.shear, kAngleOfUse, 0.0) * (a * a + b * b) / (2.0 * a * b);
    for (int j = 0; j + 1 < rows; ++j) {
      for (int i = 0; i + 1 < columns; ++i) {
        addLink(particle(i, j), particle(i + 1, j + 1), shear);
        addLink(particle(i + 1, j), particle(i, j + 1), shear);
      }
    }
  }

  /// A chord over two cells of length l shortens by l φ²/4 when the thread turns by φ, so its
  /// energy is proportional to φ⁴, not φ². It is matched to the energy of the law, ½ B (w/l) φ², at
  /// the angle by which the cloth turns under its own weight, over the length (B/ρg)^⅓.
  double bendingSpring(int direction, double along, double across) {
    const double rigidity = secant(scene_.cloth.fabric.bending[direction], kCurvatureOfUse, 0.0);
    const double weight = scene_.cloth.fabric.areal_density * scene_.gravity.norm();
    if (!(rigidity > 0.0)) return 0.0;
    const double turn = weight > 0.0 ? std::min(kMostTurn, along / std::cbrt(rigidity / weight)) : kMostTurn;
    bending_spring_ = 16.0 * rigidity * across / (along * along * along * turn * turn);
    return bending_spring_;
  }

  /// Bullet's soft solver removes a share of each error in an iteration. This share is that of one
  /// particle pair with the spring in one implicit step, spread over the iterations.
  btScalar strength(int a, int b, double stiffness) const {
    if (deformable_) return static_cast<btScalar>(stiffness);
    const double w = cloth_->m_nodes[a].m_im + cloth_->m_nodes[b].m_im;
    const double share = stiffness * h_ * h_ * w / (1.0 + stiffness * h_ * h_ * w);
    return static_cast<btScalar>(1.0 - std::pow(1.0 - share, 1.0 / iterations_));
  }

  void addLink(int a, int b, double stiffness) {
    if (!(stiffness > 0.0) || cloth_->m_nodes[a].m_im + cloth_->m_nodes[b].m_im == 0) return;
    const btScalar value = strength(a, b, stiffness);
    btSoftBody::Material* material = nullptr;
    for (int k = 1; k < cloth_->m_materials.size() && material == nullptr; ++k) {
      if (cloth_->m_materials[k]->m_kLST == value) material = cloth_->m_materials[k];
    }
    if (material == nullptr) {
      material = cloth_->appendMaterial();
      material->m_kLST = value;
    }
    cloth_->appendLink(a, b, material, false);
  }

  /// Bullet has no half spaces for soft bodies, so a plane is the upper side of a large box.
  void addObstacle(const Obstacle& obstacle) {
    constexpr double kExtent = 2.0;  // [m]
    Vec3 centre = obstacle.pose.position;
    std::unique_ptr<btConvexInternalShape> shape;
    switch (obstacle.shape) {
      case Shape::Sphere:
        shape = std::make_unique<btSphereShape>(static_cast<btScalar>(obstacle.radius));
        break;
      case Shape::Box:
        shape = box(obstacle.size);
        break;
      case Shape::Plane:
        shape = box(Vec3::Constant(kExtent));
        centre -= obstacle.pose.orientation * Vec3(0.0, 0.0, 0.5 * kExtent);
        break;
      case Shape::Capsule:
        shape = std::make_unique<btCapsuleShapeZ>(static_cast<btScalar>(obstacle.radius),
                                                  static_cast<btScalar>(obstacle.length));
        break;
      case Shape::Cylinder:
        shape = std::make_unique<btCylinderShapeZ>(
            toBullet({obstacle.radius, obstacle.radius, 0.5 * obstacle.length}));
        shape->setMargin(static_cast<btScalar>(std::min(margin(), 0.5 * obstacle.radius)));
        break;
    }
    const Quat& q = obstacle.pose.orientation;
    const btQuaternion turn(static_cast<btScalar>(q.x()), static_cast<btScalar>(q.y()),
                            static_cast<btScalar>(q.z()), static_cast<btScalar>(q.w()));
    btRigidBody* body =
        addBody(std::move(shape), 0.0, btTransform(turn, toBullet(centre)), obstacle.friction);
    if (obstacle.path.empty()) return;
    body->setCollisionFlags(body->getCollisionFlags() | btCollisionObject::CF_KINEMATIC_OBJECT);
    body->setActivationState(DISABLE_DEACTIVATION);
  }

  std::unique_ptr<btConvexInternalShape> box(const Vec3& size) const {
    auto shape = std::make_unique<btBoxShape>(toBullet(0.5 * size));
    shape->setMargin(static_cast<btScalar>(std::min(margin(), 0.25 * size.minCoeff())));
    return shape;
  }

  btRigidBody* addBody(std::unique_ptr<btConvexInternalShape> shape, double mass, const btTransform& pose,
                       double friction) {
    btRigidBody::btRigidBodyConstructionInfo info(static_cast<btScalar>(mass), nullptr, shape.get(),
                                                  btVector3(0, 0, 0));
    info.m_startWorldTransform = pose;
    info.m_friction = static_cast<btScalar>(friction);
    bodies_.push_back(std::make_unique<btRigidBody>(info));
    shapes_.push_back(std::move(shape));
    world_->addRigidBody(bodies_.back().get());
    return bodies_.back().get();
  }

  /// A kinematic body receives no impulses. So the probe is a heavy body that is moved to its place
  /// in every step, and its velocity shows the impulses.
  void addProbe() {
    const btTransform pose(btQuaternion::getIdentity(), toBullet(scene_.probes[0].path.front().position));
    probe_ = addBody(std::make_unique<btSphereShape>(static_cast<btScalar>(scene_.probes[0].radius)),
                     kProbeMass, pose, scene_.probes[0].friction);
    probe_->setGravity(btVector3(0, 0, 0));
    probe_->setFlags(probe_->getFlags() | BT_DISABLE_WORLD_GRAVITY);
    probe_->setActivationState(DISABLE_DEACTIVATION);
    for (int k = 0; k + 1 < static_cast<int>(bodies_.size()); ++k) {
      probe_->setIgnoreCollisionCheck(bodies_[k].get(), true);
    }
  }

  Scene scene_;
  bool deformable_;
  int iterations_, newton_;
  double h_;
  double bending_spring_ = 0.0;  ///< [N/m]
  std::unique_ptr<btDbvtBroadphase> broadphase_;
  std::unique_ptr<btSoftBodyRigidBodyCollisionConfiguration> configuration_;
  std::unique_ptr<btCollisionDispatcher> dispatcher_;
  std::unique_ptr<DeformableSolver> deformable_solver_;
  std::unique_ptr<btConstraintSolver> solver_;
  std::unique_ptr<btDiscreteDynamicsWorld> world_;
  btDeformableMultiBodyDynamicsWorld* deformable_world_ = nullptr;
  btSoftRigidDynamicsWorld* soft_world_ = nullptr;
  btSoftBodyWorldInfo* info_ = nullptr;
  std::vector<std::unique_ptr<btDeformableLagrangianForce>> forces_;
  std::vector<std::unique_ptr<btConvexInternalShape>> shapes_;
  std::vector<std::unique_ptr<btRigidBody>> bodies_;
  std::unique_ptr<btSoftBody> cloth_;
  double time_ = 0.0;
  std::vector<MovedParticle> moved_ = movedParticles(scene_);
  std::vector<Held> held_;
  int most_self_contacts_ = 0;
  btRigidBody* probe_ = nullptr;
  Vec3 probe_position_ = Vec3::Zero(), force_ = Vec3::Zero();
};

}  // namespace
}  // namespace peers
}  // namespace haptic_cloth

int main(int argc, char** argv) {
  using namespace haptic_cloth;  // a separate main
  return peers::runPeer(argc, argv, "bullet_cloth",
                        "The scene's cloth with Bullet's soft bodies, for the bench.",
                        [](const Scene& scene, const peers::Arguments& arguments) {
                          return std::make_unique<peers::BulletCloth>(scene, arguments);
                        });
}
