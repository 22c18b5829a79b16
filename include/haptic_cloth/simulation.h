/// The simulation: cloth, obstacles and probes.
#pragma once

#include <array>
#include <cstdint>
#include <functional>
#include <memory>
#include <string>
#include <utility>
#include <vector>

#include "haptic_cloth/report.h"
#include "haptic_cloth/scene.h"

namespace haptic_cloth {

/// One leaf of the adaptive mesh, for display and output.
struct CellView {
  /// Corners (i,j), (i+s,j), (i,j+s), (i+s,j+s) as finest-grid indices j·I + i.
  std::array<int, 4> particles;
  int level;            ///< 0: finest
  bool diagonal_rises;  ///< its two triangles share corners 0 and 3, else 1 and 2
};

/// Poses of devices and obstacles beyond this distance from the origin are ignored [m], and devices that
/// are faster [m/s], so that no square or quotient overflows: about the circumference of the earth.
constexpr double kFarthestPose = 4e7;

class ClothWorld;

/// Cloth, obstacles and probes, advanced step by step. Not thread-safe: one thread owns it. Calls about a
/// probe or an obstacle throw InputError, with nothing changed, if the scene has none of that number. One
/// that was moved from may only be assigned or destroyed.
class Simulation {
 public:
  /// @throws InputError if the scene is not valid or needs more memory than available, or if
  /// HAPTIC_CLOTH_SIMD names no instruction set of this machine
  explicit Simulation(const Scene& scene);
  ~Simulation();
  Simulation(Simulation&&) noexcept;
  Simulation& operator=(Simulation&&) noexcept;

  /// Sets the device's position [m] and velocity [m/s] for the next step. The first call places the
  /// proxy at the device.
  void setDevice(const Vec3& position, const Vec3& velocity) { setDevice(0, {position, velocity}); }

  /// Sets the state of a probe by its number in the scene. A state that is not finite or beyond
  /// kFarthestPose is ignored. A state farther from the last one than a hand can move (isJump()) or turn a
  /// capsule or closed probe (isTurnJump()) counts as removal and reappearance: the probe is open, and
  /// touches nothing until it has been clear of the cloth once.
  void setDevice(int probe, const DeviceState& device);

  /// Removes a probe from the scene until its next setDevice().
  void removeDevice(int probe = 0);

  /// Opens or closes a probe. A closed probe holds the cloth that it touches, or touches next,
  /// until it is opened or removed. Held particles move with the proxy.
  void setGrasp(int probe, bool closed);

  /// Sets the target pose of an obstacle. It moves there in the following steps, at most a quarter
  /// of its narrowest half-width and 0.25 rad about an axis of symmetry in each. A pose that is not finite or
  /// beyond kFarthestPose is ignored.
  void moveObstacle(int obstacle, const Pose& pose);

  /// Changes options from the next step on. The solver's time_step, integrator, cost,
  /// preconditioner and threads and the mesh's strategy, start and levels must not change.
  /// @param air_damping drag of still air [1/s]
  /// @throws InputError, with nothing changed, if one of those differs or a value is invalid
  void setOptions(const SolverOptions& solver, const AdaptOptions& adapt, double air_damping);

  /// Changes the coupling of a probe from the next step on: stiffness [N/m], damping [N·s/m].
  /// @throws InputError, with nothing changed, if a value is invalid
  void setCoupling(int probe, double stiffness, double damping);

  /// Makes one step: move obstacles, adapt the mesh, update grasps, find contacts, minimise, accept or
  /// restore. Numerical trouble does not throw: the last good state is restored, and the report says
  /// `failed`.
  /// @param length of the step in units of the scene's solver.time_step; less than 1 counts as 1. Mesh
  /// decisions and ages of cells count in these units, particles fall asleep by steps.
  StepReport step(int length = 1);

  /// Returns to the flat cloth at time 0, without probes, with the obstacles as in the scene. Options and
  /// couplings that were changed stay.
  void reset();

  /// Complete state between two steps, for loadState() in this or another process. Files:
  /// haptic_cloth/state_file.h.
  std::string saveState() const;

  /// Continues from a saved state, bit for bit, with any number of threads. The scenes must be
  /// equal except for paths, orientations on them, grasps, stop, threads and time budget. A path that gives
  /// an obstacle its position must begin at the same place.
  /// @param origin name of the source in messages
  /// @throws InputError naming the difference or error, or the place where cloth that meetsItself()
  /// passes through itself; the simulation is then unchanged
  void loadState(const std::string& saved, const std::string& origin);

  /// As given, with the changes by setOptions() and setCoupling(). Valid until reset() or loadState().
  const Scene& scene() const;
  double time() const;  ///< simulated time since reset [s]
  int threads() const;  ///< largest number that a step uses
  double mass() const;  ///< mass of the cloth [kg]
  int activeParticles() const;
  bool meetsItself() const;  ///< layers press on each other; false: they pass through each other
  ProbeReport probe(int probe = 0) const;
  Pose obstaclePose(int obstacle) const;
  EnergyReport energy() const;  ///< at the end of the last step [J]
  CostReport cost() const;      ///< costs of the last solve [J]
  double maxStrain() const;     ///< largest |strain| of an edge [-]
  double maxSpeed() const;      ///< largest speed of an active particle [m/s]
  Vec3 supportForce() const;    ///< force of pins and obstacles on the cloth [N]

  /// Takes a line of a recording, without its end.
  using Sink = std::function<void(const std::string& line)>;

  /// Starts a recording for `simulate --replay` (docs/reference/recordings.md): hands its first lines to
  /// `sink`, and one for each later call that changes the simulation, on the thread of that call. The last
  /// line follows at record(nullptr), at another record() and at loadState(), which is not recorded.
  /// @pre nothing was changed and no step was made since the start or reset(): options that were changed
  /// before do not fit the scene's file, and other changes are missing, so the replay ends in another state.
  /// The replay needs a scene file that describes this scene
  /// @throws what `sink` throws; the recording then ends, without its last line
  void record(Sink sink);

  /// Hash over the bits of positions, velocities, proxies and time: equal for equal bits.
  std::uint64_t stateHash() const;

  /// Finds where the cloth passes through itself: pairs of an edge and a triangle that cut each other,
  /// of the surface with two triangles for each leaf. Takes about as long as a step.
  Crossings crossings() const;

  /// Positions [m] of all I·J finest particles, index j·I + i. Inactive ones are interpolated in
  /// their cell.
  void positions(std::vector<Vec3>& positions) const;

  /// Flags of all finest particles: 1 if active (simulated; hanging nodes are not).
  void activeFlags(std::vector<char>& flags) const;

  /// Leaves of the mesh in a fixed order.
  void cells(std::vector<CellView>& cells) const;

  /// Largest loads of each leaf, one number a leaf in the order of cells(): tension of the edges at its
  /// corners, 0 if they are compressed [N/m], and bending energy per area of the triples there [J/m²].
  void cellLoads(std::vector<float>& tension, std::vector<float>& bending) const;

 private:
  void requireProbe(int probe) const;
  void requireObstacle(int obstacle) const;

  std::unique_ptr<ClothWorld> world_;
  Sink sink_;
};

/// Sends each probe and obstacle that has a path in the scene to where its path leads at the end of
/// the next step, and opens and closes grasps at their times. Call it before each step(), as
/// `simulate` does.
/// @param length of the next step, as for step()
void followPaths(Simulation& simulation, int length = 1);

}  // namespace haptic_cloth
