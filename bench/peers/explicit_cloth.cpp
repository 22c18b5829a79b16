/// explicit_cloth: symplectic Euler on the package's own energies, finest mesh, at its largest
/// stable step. Surface normals, contact candidates, friction and the history of the fabric are
/// updated once per solver.time_step, as in the package; candidates also when something has moved
/// beyond their range. Forces are evaluated every step. The cloth does not meet itself, and there are
/// neither moving obstacles nor grasps.
#include <algorithm>
#include <cmath>

#include "contact/contact_set.h"
#include "energy/internal_energy.h"
#include "mesh/active_mesh.h"
#include "peer.h"

namespace haptic_cloth {
namespace peers {
namespace {

constexpr double kSlipSpeed = 3e-4;  // below it friction is regularised, as in the package [m/s]
constexpr double kSafety = 0.9;      // share of the linear limit in the first attempt
constexpr double kMaxStrain = 1.0;   // no cloth of the bench is stretched to twice its length
// Energy created without a source, as a share of the largest kinetic or supplied energy, above
// which a run counts as unstable. With a sliding probe 1 % occurred at every step down to 1e-6 s,
// so it is no sign of instability; the cause is unknown.
constexpr double kEnergyCreated = 0.01, kEnergyCreatedByProbe = 0.05;

Grid finest(const Scene& scene) {
  const auto& [columns, rows] = scene.cloth.particles;
  return {columns, rows, 0, scene.cloth.size[0] / (columns - 1), scene.cloth.size[1] / (rows - 1)};
}

class ExplicitCloth : public Peer {
 public:
  ExplicitCloth(const Scene& scene, double step)
      : scene_(scene),
        grid_(finest(scene)),
        leaves_(grid_, scene.cloth.pins, 0),
        mesh_(leaves_, scene.cloth.fabric.areal_density),
        internal_(scene.cloth.fabric, mesh_),
        moved_(movedParticles(scene)),
        contacts_(grid_, scene.obstacles, scene.probes,
                  {scene.cloth.fabric.thickness, kSlipSpeed, scene.solver.time_step}, team_) {
    if (!scene.probes[0].grasp.empty()) throw std::runtime_error("no grasps here");
    for (const Obstacle& obstacle : scene.obstacles) {
      if (!obstacle.path.empty()) throw std::runtime_error("no moving obstacles here");
    }
    const std::vector<Vec3> flat = flatCloth(scene);
    for (Field* field : {&x_, &v_, &gradient_}) field->clear(mesh_.nodes());
    for (int n = 0; n < mesh_.nodes(); ++n) x_.set(n, flat[mesh_.particle[n]]);
    start_ = x_;
    reach_.assign(mesh_.nodes(), 0.0);
    motion_.clear(mesh_.nodes());
    if (step <= 0.0) step = stableStep();
    parts_ = std::max(1, static_cast<int>(std::ceil(scene.solver.time_step / step - 1e-9)));
    h_ = scene.solver.time_step / parts_;
    internal_.setNormals(x_);
    collect();
    lowest_ = storedEnergy(evaluate()) + gravityEnergy();
  }

  double frame() const override { return scene_.solver.time_step; }

  void step(const Vec3* device, const Vec3& device_velocity) override {
    if (device != nullptr) present_ = true;
    const bool first = present_ && !placed_;
    if (first) proxy_ = *device;
    placed_ = present_;
    stopEjected();
    internal_.setNormals(x_);
    collect();
    force_ = Vec3::Zero();
    const Vec3 end = device != nullptr ? *device : proxy_;
    for (int k = 1; k <= parts_; ++k) {
      if (!covered()) collect();
      const Vec3 now = end - device_velocity * (h_ * (parts_ - k));
      advance(now, device_velocity);
    }
    force_ /= parts_;
    internal_.commit(0, internal_.size(), x_);
    check();
  }

  void positions(std::vector<Vec3>& positions) const override {
    positions.resize(grid_.particles());
    for (int n = 0; n < mesh_.nodes(); ++n) positions[mesh_.particle[n]] = x_[n];
  }

  Vec3 probe() const override { return proxy_; }
  Vec3 probeForce() const override { return force_; }

  nlohmann::json details() const override {
    return {{"method", "symplectic Euler, the package's energies"},
            {"step", h_},
            {"halves", true},
            {"parts_of_a_frame", parts_},
            {"collections", collections_},
            {"energy_created", worst_}};
  }

 private:
  /// Linear limit 2/ω of the flat cloth. For a chain of springs ω² is twice the diagonal over the
  /// mass, for bending 8/3 times.
  double stableStep() {
    internal_.setNormals(x_);
    internal_.evaluate(0, internal_.size(), x_);
    BlockField blocks;
    blocks.clear(mesh_.nodes());
    internal_.addBlocks(0, 1, blocks);
    double largest = 0.0;
    for (int n = 0; n < mesh_.free; ++n) {
      largest = std::max(largest, 2.0 * blocks[n].head<3>().maxCoeff() / mesh_.mass[n]);
    }
    return largest > 0.0 ? kSafety * 2.0 / std::sqrt(largest) : scene_.solver.time_step;
  }

  void collect() {
    const double frame = scene_.solver.time_step;
    for (int n = 0; n < mesh_.nodes(); ++n) {
      motion_.set(n, frame * v_[n]);
      reach_[n] =
          2.0 * frame * (v_[n].norm() + frame * scene_.gravity.norm()) + 0.1 * std::min(grid_.dx, grid_.dy);
    }
    start_ = x_;
    proxy_start_ = proxy_;
    proxy_reach_ = 2.0 * frame * proxy_velocity_.norm() + 0.1 * scene_.probes[0].radius;
    contacts_.startProbe(0, proxy_, Quat::Identity(), Quat::Identity());
    if (present_ && !entered_) entered_ = !contacts_.wayOut(mesh_, x_, 0);
    touching_.clear();
    if (present_ && entered_) touching_.push_back({0, proxy_reach_});
    contacts_.collectProbes(mesh_, x_, reach_, motion_, touching_);
    contacts_.collectObstacles(mesh_, x_, reach_, motion_);
    ++collections_;
  }

  bool covered() const {
    if (present_ && (proxy_ - proxy_start_).norm() > proxy_reach_) return false;
    for (int n = 0; n < mesh_.free; ++n) {
      if ((x_[n] - start_[n]).squaredNorm() > reach_[n] * reach_[n]) return false;
    }
    return true;
  }

  /// Stops what obstacles eject: it is not thrown.
  void stopEjected() {
    ejected_.assign(mesh_.nodes(), 0);
    contacts_.markEjected(ejected_);
    for (int n = 0; n < mesh_.nodes(); ++n) {
      if (ejected_[n] != 0) v_.set(n, Vec3::Zero());
    }
  }

  /// Energy of fabric and contact [J]; gradient_ is its gradient.
  double evaluate() {
    const InternalEnergy::Energy e = internal_.evaluate(0, internal_.size(), x_);
    contacts_.placeProbe(0, proxy_);
    const ContactSet::Energy c = contacts_.evaluate(0, contacts_.size(), x_);
    gradient_.fill(0.0);
    internal_.addGradient(0, mesh_.nodes(), gradient_);
    contacts_.addGradient(0, mesh_.nodes(), gradient_);
    contact_ = c.solids + c.layers;
    return e.stretch + e.bend + e.shear + contact_;
  }

  /// Moves proxy and cloth. The proxy has no mass: damper and spring of the coupling balance the
  /// force of the cloth, implicit in the coupling and explicit in the cloth.
  void advance(const Vec3& device, const Vec3& device_velocity) {
    evaluate();
    const double slowed = 1.0 / (1.0 + scene_.air_damping * h_);
    for (int c = 0; c < 3; ++c) {
      double* x = x_.coordinate(c).data();
      double* v = v_.coordinate(c).data();
      const double* f = gradient_.coordinate(c).data();
      const double g = scene_.gravity[c];
      for (int n = 0; n < mesh_.free; ++n) {
        v[n] = slowed * (v[n] + h_ * (g - f[n] / mesh_.mass[n]));
        x[n] += h_ * v[n];
      }
    }
    movePins();
    if (!present_) return;
    const Vec3 force = -contacts_.proxyGradient(0);
    const double k = scene_.probes[0].coupling_stiffness, b = scene_.probes[0].coupling_damping;
    proxy_velocity_ = (force + k * (device - proxy_) + b * device_velocity) / (b + k * h_);
    proxy_ += h_ * proxy_velocity_;
    supplied_ -= h_ * force.dot(proxy_velocity_);
    force_ += force;
  }

  /// Moves the pins; gradient_ is the force on them before, at half a step from the middle of the motion.
  void movePins() {
    time_ += h_;
    for (const MovedParticle& moved : moved_) {
      const int n = mesh_.node[moved.particle];
      const Vec3 place = moved.position(time_);
      supplied_ += gradient_[n].dot(place - x_[n]);
      x_.set(n, place);
    }
  }

  /// Energy that the fabric can return. For laws with memory this is less than the work done on
  /// them.
  double storedEnergy(double evaluated) const {
    if (!internal_.hasMemory()) return evaluated;
    const InternalEnergy::Energy e = internal_.stored(x_);
    return e.stretch + e.bend + e.shear + contact_;
  }

  /// Kinetic energy [J] at the time of the positions; velocities are half a step behind them.
  double kineticEnergy() const {
    double sum = 0.0;
    for (int n = 0; n < mesh_.free; ++n) {
      const Vec3 v = v_[n] + 0.5 * h_ * (scene_.gravity - gradient_[n] / mesh_.mass[n]);
      sum += 0.5 * mesh_.mass[n] * v.squaredNorm();
    }
    return sum;
  }

  double gravityEnergy() const {
    double sum = 0.0;
    for (int n = 0; n < mesh_.active(); ++n) sum -= mesh_.mass[n] * scene_.gravity.dot(x_[n]);
    return sum;
  }

  /// Checks stability. Only the probe and moving pins can add energy; a further increase means instability.
  void check() {
    const double strain = internal_.maxStrain(x_);
    if (!(strain < kMaxStrain)) throw Unstable("strain " + std::to_string(strain));
    const double potential = storedEnergy(evaluate()), kinetic = kineticEnergy();
    const double energy = potential + kinetic + gravityEnergy() - supplied_;
    lowest_ = std::min(lowest_, energy);
    throughput_ = std::max({throughput_, kinetic, std::abs(supplied_)});
    const double created = throughput_ > 0.0 ? (energy - lowest_) / throughput_ : 0.0;
    worst_ = std::max(worst_, created);
    if (!(created <= (present_ || !moved_.empty() ? kEnergyCreatedByProbe : kEnergyCreated)))
      throw Unstable("energy created " + std::to_string(created));
  }

  Scene scene_;
  Grid grid_;
  LeafMesh leaves_;
  ActiveMesh mesh_;
  InternalEnergy internal_;
  Team team_{1};
  std::vector<MovedParticle> moved_;
  ContactSet contacts_;
  std::vector<ContactSet::Reach> touching_;
  Field x_, v_, gradient_, start_;
  std::vector<double> reach_;
  Field motion_;
  std::vector<char> ejected_;  ///< scratch of stopEjected(): a flag for each node
  double h_ = 0.0;
  int parts_ = 1;
  bool present_ = false, placed_ = false, entered_ = false;
  Vec3 proxy_ = Vec3::Zero(), proxy_start_ = Vec3::Zero(), proxy_velocity_ = Vec3::Zero();
  Vec3 force_ = Vec3::Zero();
  double proxy_reach_ = 0.0;
  double time_ = 0.0;
  double lowest_ = 0.0, supplied_ = 0.0, contact_ = 0.0;
  double throughput_ = 0.0, worst_ = 0.0;
  long collections_ = 0;
};

}  // namespace
}  // namespace peers
}  // namespace haptic_cloth

int main(int argc, char** argv) {
  using namespace haptic_cloth;  // a separate main
  return peers::runPeer(argc, argv, "explicit_cloth",
                        "Explicit integration of the package's own energies, for the bench.",
                        [](const Scene& scene, const peers::Arguments& arguments) {
                          return std::make_unique<peers::ExplicitCloth>(scene, arguments.step);
                        });
}
