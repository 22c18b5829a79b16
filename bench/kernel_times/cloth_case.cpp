#include "cloth_case.h"

#include <algorithm>
#include <cmath>
#include <ctime>

#include "haptic_cloth/scene.h"

namespace haptic_cloth {
namespace {

// Distance from the last state, far below a cell and far above rounding, like that of a late
// iteration of a solve [m].
constexpr double kAway = 1e-6;

/// Pseudo-random number in -1..1 with equal bits on every machine.
double scatter(int k) {
  const double value = 43758.5453 * std::sin(12.9898 * (k + 1));
  return 2.0 * (value - std::floor(value)) - 1.0;
}

Scene sceneOf(const CaseOptions& options) {
  const std::string side = std::to_string(options.side);
  return loadScene(HAPTIC_CLOTH_SCENES "/box_drape.yaml",
                   {"cloth.particles=[" + side + ", " + side + "]", "cloth.fabric=" + options.fabric,
                    "adapt.strategy=" + options.strategy, "solver.sleep_speed=0", "stop.rest_speed=0",
                    "solver.threads=" + std::to_string(options.threads)});
}

/// An objective that costs almost nothing, so that only the minimizer is measured. Its gradients
/// are equal except for the first entry, which grows, so directions stay conjugate, as most are in
/// a solve.
class VectorsOnly : public Objective {
 public:
  explicit VectorsOnly(const ClothObjective& cloth) : cloth_(cloth) {}

  int size() const override { return cloth_.size(); }
  double evaluate(const Vector&, Vector& gradient) override {
    constexpr int kBuffers = 3;  // number of vectors between which the minimizer's gradients rotate
    if (++calls_ <= kBuffers) gradient.head(size()).setConstant(kAway);
    gradient[0] = calls_ * kAway;
    return -calls_;  // always low enough to be accepted
  }
  Along along(const Vector&, double slope) override { return {1.0, -slope}; }
  void fitPreconditioner(bool /*thoroughly*/) override {}
  void precondition(const Vector&, Vector& z) override {
    if (calls_ == 1) z.head(size()).setConstant(kAway);
  }
  double residual(const Vector& gradient) const override { return cloth_.residual(gradient); }

 private:
  const ClothObjective& cloth_;
  int calls_ = 0;
};

MinimizerOptions endless(MinimizerOptions options, int iterations) {
  options.tolerance = 0.0;
  options.max_iterations = iterations;
  options.time_budget = 0.0;
  return options;
}

}  // namespace

ClothCase::ClothCase(const CaseOptions& options)
    : options_(options),
      world_(std::make_unique<ClothWorld>(sceneOf(options))),
      adaptation_(scene().adapt, cloth().grid()),
      minimizer_(scene().solver.minimizer) {
  while (world_->time() < options.time) world_->step();
  const double h = scene().solver.time_step;
  reach_.assign(mesh().nodes(),
                2.0 * h * h * scene().gravity.norm() + 0.1 * std::min(cloth().grid().dx, cloth().grid().dy));
  still_.clear(mesh().nodes());
  const int capacity = objective().capacity();
  minimizer_.reserve(capacity);
  for (Vector* v : {&point_, &direction_, &scratch_, &start_}) v->setZero(capacity);
  nodes_ = motion_ = gradient_ = objective().nodes();
  objective().pack(nodes_, point_);
  for (int k = 0; k < objective().size(); ++k) {
    point_[k] += kAway * scatter(k);
    direction_[k] = kAway * scatter(7 * k + 1);
  }
  proxies_.assign(scene().probes.size(), Proxy());
  objective().unpack(direction_, motion_, proxies_);
  objective().unpack(point_, nodes_, proxies_);
  measureUnder();
}

/// Sets the terms of inertia and gravity as the objective does.
void ClothCase::measureUnder() {
  const ActiveMesh& mesh = cloth().mesh();
  start_nodes_ = inertial_ = nodes_;
  mass_.assign(padded(mesh.nodes()), 0.0);
  moving_mass_ = mass_;
  std::copy(mesh.mass.begin(), mesh.mass.end(), mass_.begin());
  std::copy_n(mesh.mass.begin(), mesh.free, moving_mass_.begin());
  const Vec3 g = scene().gravity;
  terms_ = {mass_.data(),          moving_mass_.data(),   {g.x(), g.y(), g.z()},
            objective().inertia(), start_nodes_.arrays(), inertial_.arrays()};
}

ClothCase::Iterations ClothCase::minimize(Objective& potential, int iterations) {
  minimizer_.setOptions(endless(scene().solver.minimizer, iterations));
  start_ = point_;
  const double value = potential.evaluate(start_, scratch_);
  const std::clock_t before = std::clock();
  MinimizerReport report;
  world_->team_.run(mesh().active(),
                    [&] { report = minimizer_.minimize(potential, start_, value, scratch_, world_->team_); });
  const double cpu = static_cast<double>(std::clock() - before) / CLOCKS_PER_SEC;
  return {report.iterations, report.evaluations, report.seconds, cpu};
}

void ClothCase::lookAtMesh() {
  const AdaptOptions& adapt = scene().adapt;
  const TurnEstimate::View view = world_->turnView();
  TurnEstimate& turns = world_->turns_;
  turns.begin(view, std::min(adapt.refine_above, adapt.coarsen_below));
  adaptation_.plan(
      {0,
       nodes(),
       {},
       cloth().leaves(),
       mesh(),
       cloth().state(),
       [&](const Cell& cell, int parts, double enough) { return turns.turn(view, cell, parts, enough); },
       [&](const Cell& cell, int parts) { return turns.carries(view, cell, parts, adapt.near_load); },
       [](const Cell&, int, double) { return true; }});
}

ClothCase::Iterations ClothCase::iterate(int iterations) { return minimize(objective(), iterations); }

ClothCase::Iterations ClothCase::iterateVectors(int iterations) {
  VectorsOnly vectors(objective());
  return minimize(vectors, iterations);
}

}  // namespace haptic_cloth
