/// Runs scenes in which methods tend to fail, and checks each against the same criteria.
#pragma once

#include <functional>
#include <string>
#include <vector>

#include "sim/cloth_world.h"
#include "support/scenes.h"

namespace haptic_cloth {

/// Criteria of a run. Every case also requires finite values, equal bits for one and two threads, no
/// crossing after any step (contact/crossings.h) and the energy balance, so these are not listed.
///
/// Balance: energy minus work may rise above its lowest value so far by round-off, kRoundOff of the
/// turnover, plus the work of residual forces since then, residual · weight · distance. If Newton's
/// law is met up to R, a backward Euler step gains at most R · Δx; by Cauchy and Schwarz that is
/// residual · |g| · mass · rms_m(Δx). The residual is the reported one or the tolerance. A mesh
/// change creates energy at once, which motion returns later; so do surface normals, which turn
/// between steps. Both are allowed, up to a tenth and a hundredth of the turnover. The whole rise
/// is at most a tenth of the turnover, because the residual of a step cut short far from its
/// solution would explain any rise.
///
/// Speed: speedLimit() is the sum of three sources. Devices, obstacles and pins give at most twice their
/// speed (a heavy body hits a light one without loss). A fall gives √(2 g · 2 · depth), since half
/// of a chain may get the energy that the other half has lost, and its tip outruns free fall
/// [Tomaszewski et al. 2006]. The fabric gives at most the energy stored at the largest strain of
/// the run: ρ v²/2 = w_warp + w_weft. The speed is twice that v at a free edge, where a wave is
/// reflected, or where one quarter of the cloth gets all the energy.
///
/// Strain: if a case states no limit, strainLimit() is a sum. One part is the strain of the threads
/// that carry all loads: the forces of the probes and twice the weight, as it acts suddenly. The
/// other is that of cloth with the speed that inputs and fall explain, twice that at a held edge,
/// stopped at once along its softer, compressed direction.
///
/// Force: the force on a probe is at most what its coupling can exert, k · distance + b · speeds of
/// both ends, plus the residual of the proxy, which counts with the mass h² k + h b.
struct TortureLimits {
  /// Largest |strain| of an edge in the whole run [-]; 0: strainLimit().
  double strain = 0.0;
  /// A probe pushes the cloth together as hard as it pulls, along its softer direction: extension
  /// and shortening then have separate limits, the latter at most 1.
  bool pushed = false;
  double thrown = 0.0;  ///< speed from sources not named above [m/s]
  /// Reason why speedLimit() would have no meaning and speed is not checked; empty: it is checked.
  std::string any_speed;
  /// Reason why the cloth passes through itself from the start; empty: it must not.
  std::string crossed;
  double created = 0.1;  ///< energy that one mesh change may create, over the turnover [-]
  /// Bending energy that normals may create by turning between steps, in total, over the turnover
  /// [-].
  double turned = 0.01;
  int failed = 0;  ///< number of steps whose state had to be restored
};

/// A case: a scene that `simulate` could run, plus settings that a scene file cannot express.
struct Torture {
  std::string name;
  std::string fabric_file;
  Scene scene;
  TortureLimits limits;
  /// Number of steps before the energy balance begins; changes of the state in these are not
  /// physical.
  long set_up = 0;
  std::function<void(ClothWorld&, long step)> before = {};       ///< before each step
  std::function<void(const ClothWorld&, long step)> after = {};  ///< after each step
  /// Length of each step in units of the scene's time_step; empty: 1.
  std::function<int(long step)> length = {};
};

/// Result of a run.
struct TortureResult {
  long steps = 0, failed = 0, cut = 0;  ///< cut: steps that stopped before their tolerance
  bool finite = true;
  double strain = 0.0, speed = 0.0;
  double stretched = 0.0, shortened = 0.0;  ///< largest strain above and below zero [-]
  double driven = 0.0;                      ///< largest speed of a device, an obstacle or a pin [m/s]
  /// Largest distance that a particle moved along gravity from its start [m].
  double sunk = 0.0;
  int crossings = 0;         ///< most pairs after a step
  long shortened_steps = 0;  ///< of which only a part was made
  int pairs = 0;             ///< most pairs of parts of the cloth that pressed at once
  double unexplained = 0.0;  ///< force on a probe beyond what its coupling can exert [N]
  double force = 0.0;        ///< largest force on a probe [N]
  double penetration = 0.0;  ///< [m]
  /// Turnover: weight of the cloth times its size, plus work of probes and obstacles [J].
  double energy = 0.0;
  double gain = 0.0;  ///< largest rise of energy minus work above its lowest value [J]
  /// Part of that rise explained by residuals and mesh changes [J].
  double allowed = 0.0;
  /// Largest energy created by one mesh change over the turnover until then [-].
  double created = 0.0;
  /// Bending energy created by normals that turn between steps, in total [J].
  double turned = 0.0;
  double left = 0.0;  ///< distance of the proxies from their devices at the end [m]
  std::uint64_t hash = 0;
};

/// Largest speed [m/s] and strain [-] that the run's own inputs explain, see TortureLimits.
double speedLimit(const TortureResult& result, const Scene& scene);
double strainLimit(const TortureResult& result, const Scene& scene, bool pushed);

/// Strain by which warp or weft is compressed by the energy that it has at a strain; at least that
/// strain [-].
double rebound(const Fabric& fabric, double strain);

/// Writes a fabric with linear laws to a file that outlives the program's scenes. @return its path
std::string writeFabric(const LinearFabric& linear);

/// Writes a fabric that hardly resists compression; its bending rigidity is 10 μN·m. @return its
/// path
std::string lightFabric();

std::string shippedFabric(const std::string& name);

/// Sheet as in sheetScene(), with the file of its fabric.
Torture tortureSheet(const std::string& name, const std::string& fabric_file, int warp, int weft,
                     double length, double width);

/// Runs a case and checks its limits. A failed case leaves a scene with the paths of the probes in
/// $HAPTIC_CLOTH_TORTURE_OUT (default: torture_failures), and prints the command that replays it.
TortureResult torture(const Torture& wanted);

/// Writes the files of a case: DIR/scene.yaml, DIR/fabric.yaml. @return path of the scene
std::string saveTorture(const Torture& wanted, const std::string& directory);

/// Records a measured value beside its limit, for the table in docs/stability.md. Appends to
/// $HAPTIC_CLOTH_TORTURE_OUT/margins.csv if that is set.
/// @param unchecked reason why the value is not checked; empty: the limit, which must be finite, is
void recordMargin(const std::string& test_case, const std::string& criterion, double measured, double limit,
                  const std::string& unit, const std::string& unchecked = "");

/// Length of a case: the environment variable if it is set, else `short_form`, which suits every
/// build.
double tortureLength(const char* variable, double short_form);

/// Capsule across the weft, which grips the end of a strip as a hand would.
ProbeOptions gripper(double length, double coupling_stiffness);

}  // namespace haptic_cloth
