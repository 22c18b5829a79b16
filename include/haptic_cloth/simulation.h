/// The cloth in its world: one object, one step.
#pragma once

#include <array>
#include <cstdint>
#include <memory>
#include <string>
#include <vector>

#include "haptic_cloth/report.h"
#include "haptic_cloth/scene.h"

namespace haptic_cloth {

/// One leaf of the adaptive mesh, for display and output.
struct CellView {
  std::array<int, 4>
      particles;  ///< corners (i,j), (i+s,j), (i,j+s), (i+s,j+s) as finest-grid indices j·I + i
  int level;      ///< 0: finest
};

/// Cloth, obstacles and probes, advanced step by step. Not thread-safe: one thread owns it.
class Simulation {
 public:
  /// @throws InputError if the scene is not valid, or needs more memory than there is
  explicit Simulation(const Scene& scene);
  ~Simulation();
  Simulation(Simulation&&) noexcept;
  Simulation& operator=(Simulation&&) noexcept;

  /// Takes the device's position [m] and velocity [m/s] for the next step. The first call puts the proxy
  /// there.
  void setDevice(const Vec3& position, const Vec3& velocity) { setDevice(0, {position, velocity}); }

  /// The same for a probe of the scene by its number. A state that is not finite is ignored. One that is
  /// farther from the last than a hand gets (isJump()) is that of a probe which was removed and appears
  /// there: open, and without touch until it has been clear of the cloth once.
  void setDevice(int probe, const DeviceState& device);

  /// Takes a probe out of the scene until its next setDevice().
  void removeDevice(int probe = 0);

  /// A closed probe holds the cloth it touches, or touches next, until it is opened or removed. Held
  /// particles move with the proxy.
  void setGrasp(int probe, bool closed);

  /// Sends an obstacle to a pose that it takes in the next step, or in several: at most a quarter of its
  /// narrowest half-width in each. A pose that is not finite is ignored.
  void moveObstacle(int obstacle, const Pose& pose);

  /// Takes over other options from the next step on. The solver's time_step, cost, preconditioner and threads
  /// and the mesh's strategy and levels stay as they are.
  /// @throws InputError, with nothing changed, for values a scene may not have and for others of those
  void setOptions(const SolverOptions& solver, const AdaptOptions& adapt, double air_damping);

  /// Another coupling of a probe from the next step on, stiffness [N/m] and damping [N·s/m].
  /// @throws InputError, with nothing changed, for values a scene may not have
  void setCoupling(int probe, double stiffness, double damping);

  /// Advances by one time step: take inputs, adapt, find contacts, minimise, accept or restore, report.
  StepReport step();

  /// Back to the flat start at time 0, without probes, obstacles as in the scene.
  void reset();

  /// The whole state between two steps, for loadState() here or in another process; files:
  /// haptic_cloth/state_file.h.
  std::string saveState() const;

  /// Goes on where saveState() was called, to the last bit, whatever the number of threads. The scene must be
  /// the same but for paths, grasps, stop, threads and time budget.
  /// @param origin names the source in messages
  /// @throws InputError naming what differs or does not fit; the simulation then is as it was
  void loadState(const std::string& saved, const std::string& origin);

  const Scene& scene() const;
  double time() const;  ///< simulated since reset [s]
  int threads() const;
  double mass() const;  ///< of the cloth [kg]
  int activeParticles() const;
  ProbeReport probe(int probe = 0) const;
  Pose obstaclePose(int obstacle) const;
  EnergyReport energy() const;
  CostReport cost() const;
  double maxStrain() const;   ///< largest |strain| of an edge [-]
  double maxSpeed() const;    ///< of an active particle [m/s]
  Vec3 supportForce() const;  ///< sum of what pins and obstacles exert on the cloth [N]

  /// Hash over the bits of the state: equal for equal bits.
  std::uint64_t stateHash() const;

  /// Positions [m] of all I·J finest particles, index j·I + i; inactive ones interpolated in their cell.
  /// `positions` is resized on first use and then reused.
  void positions(std::vector<Vec3>& positions) const;

  /// For each finest particle whether it is active (simulated; ghosts are not).
  void activeFlags(std::vector<char>& flags) const;

  /// Leaves of the mesh in a fixed order.
  void cells(std::vector<CellView>& cells) const;

  /// Largest tension of the edges [N/m] and largest bending energy per area of the triples [J/m²] at the
  /// corners of each leaf, in the order of cells().
  void cellLoads(std::vector<float>& tension, std::vector<float>& bending) const;

 private:
  class Implementation;
  std::unique_ptr<Implementation> implementation_;
};

/// Sends each probe and obstacle that has a path in the scene to where its path leads at the end of
/// the next step, and opens and closes grasps at their times. Call it before each step(), as
/// `simulate` does.
void followPaths(Simulation& simulation);

}  // namespace haptic_cloth
