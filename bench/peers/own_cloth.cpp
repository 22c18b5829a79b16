/// own_cloth: the package itself by its public interface, measured like its peers.
#include "haptic_cloth/simulation.h"
#include "peer.h"

namespace haptic_cloth {
namespace peers {
namespace {

class OwnCloth : public Peer {
 public:
  explicit OwnCloth(const Scene& scene) : simulation_(scene) {}

  double frame() const override { return simulation_.scene().solver.time_step; }

  void step(const Vec3*, const Vec3&) override {
    followPaths(simulation_);
    const StepReport report = simulation_.step();
    ++steps_;
    failed_ += report.failed ? 1 : 0;
    mean_active_ += (report.active_particles - mean_active_) / steps_;
  }

  void positions(std::vector<Vec3>& positions) const override { simulation_.positions(positions); }
  Vec3 probe() const override { return simulation_.probe().proxy; }
  Vec3 probeForce() const override { return simulation_.probe().force; }

  /// Those of the adaptive mesh: its surface has two triangles for each leaf.
  std::optional<OwnMeasure> ownMeasure() const override {
    return OwnMeasure{simulation_.crossings().pairs, simulation_.energy().total()};
  }

  nlohmann::json details() const override {
    return {{"method", "this package"},
            {"step", frame()},
            {"failed_steps", failed_},
            {"mean_active_particles", mean_active_}};
  }

 private:
  Simulation simulation_;
  int steps_ = 0, failed_ = 0;
  double mean_active_ = 0.0;
};

}  // namespace
}  // namespace peers
}  // namespace haptic_cloth

int main(int argc, char** argv) {
  using namespace haptic_cloth;  // a separate main
  return peers::runPeer(
      argc, argv, "own_cloth", "The package itself, measured like its peers.",
      [](const Scene& scene, const peers::Arguments&) { return std::make_unique<peers::OwnCloth>(scene); });
}
