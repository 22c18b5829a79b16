/// Runs scenes at which methods fail, and holds each against the same few criteria.
#pragma once

#include <functional>
#include <string>
#include <vector>

#include "sim/cloth_world.h"
#include "support/scenes.h"

namespace haptic_cloth {

/// What a run must keep to. Finite values, equal bits for one and two threads and the energy balance are
/// asked of every case, so they are not listed.
/// Balance: energy less work may not rise above its lowest so far by more than round-off, kRoundOff of what
/// was turned over, and the work of the residual forces that the steps left over, residual · weight · way,
/// since then: with Newton's law met up to R, a step of backward Euler gains R · Δx at most, and by Cauchy
/// and Schwarz that is residual · |g| · mass · rms_m(Δx); residual: what the step reports, or its tolerance.
/// A change of the mesh makes energy at once, and motion gives it back later; so do surface normals, which
/// turn between steps and not in them. Both are allowed, too, but no more than a tenth and a hundredth of
/// what was turned over. All in all the rise is no more than a tenth of that: where a step is cut short far
/// from its solution, its residual would explain any. Speed: a particle is set in motion by what devices and
/// obstacles do, twice their speed where something heavy hits something light without loss; by its fall, √(2
/// g · 2 · way it sank), since half of a chain may get what the other half has fallen, and its tip outruns
/// free fall [Tomaszewski et al. 2006]; and by what the fabric gives back, no more than it stores at the
/// largest strain of the run: ρ v²/2 = w_warp + w_weft, twice that at a free edge, where a wave is thrown
/// back, or where one quarter gets it all. speedLimit() is the sum. Strain: where a case says nothing nearer,
/// that of the threads which carry all that pulls, forces of the probes and twice the weight, as it is
/// sudden; and that of cloth which moves as fast as inputs and fall explain, twice that at a held edge, and
/// is stopped at once along its softer, compressed way: strainLimit() is the sum. Force: that on a probe is
/// what its coupling can pull with, k · distance + b · speeds of both ends; and what the residual leaves on
/// the proxy, which counts with the mass h² k + h b.
struct TortureLimits {
  double strain = 0.0;  ///< largest |strain| of an edge in the whole run; 0: strainLimit() [-]
  bool pushed = false;  ///< a probe pushes the cloth together as hard as it pulls, along its softer way: what
                        ///< is stretched and what is shortened have limits of their own, the latter at most 1
  double thrown = 0.0;  ///< speed by what is not named above [m/s]
  std::string any_speed;  ///< why speedLimit() would say nothing, so that no speed is asked; empty: it is
  double created = 0.1;   ///< energy that one change of the mesh makes, over what was turned over [-]
  double turned = 0.01;   ///< bending energy that normals make by turning between steps, in all, likewise [-]
  int failed = 0;         ///< steps whose state had to be restored
};

/// A case: a scene that `simulate` could run, and what a scene file cannot say.
struct Torture {
  std::string name;
  std::string fabric_file;
  Scene scene;
  TortureLimits limits;
  long set_up = 0;  ///< steps before the books are opened: what is done to the state in these is no physics
  std::function<void(ClothWorld&, long step)> before = {};       ///< before each step
  std::function<void(const ClothWorld&, long step)> after = {};  ///< after each step
};

/// What a run came to.
struct TortureResult {
  long steps = 0, failed = 0, cut = 0;  ///< cut: steps that ended short of their tolerance
  bool finite = true;
  double strain = 0.0, speed = 0.0;
  double stretched = 0.0, shortened = 0.0;  ///< largest strain above and below zero [-]
  double driven = 0.0;                      ///< fastest device or obstacle [m/s]
  double sunk = 0.0;         ///< farthest that a particle got along gravity from where it began [m]
  double unexplained = 0.0;  ///< force on a probe beyond what its coupling can give [N]
  double force = 0.0;        ///< largest on a probe [N]
  double penetration = 0.0;  ///< [m]
  double energy = 0.0;       ///< turned over: cloth lifted by its size, work of probes and obstacles [J]
  double gain = 0.0;         ///< largest rise of energy less work, from its lowest so far [J]
  double allowed = 0.0;      ///< what residuals could have worked, and mesh changes made, in that rise [J]
  double created = 0.0;  ///< most that one change of the mesh made, over what was turned over until then [-]
  double turned = 0.0;   ///< bending energy that normals made as they turned between steps, in all [J]
  double left = 0.0;     ///< distance of the proxies from their devices at the end [m]
  std::uint64_t hash = 0;
};

/// Largest speed [m/s] and strain [-] that the run's own inputs explain, see TortureLimits.
double speedLimit(const TortureResult& result, const Scene& scene);
double strainLimit(const TortureResult& result, const Scene& scene, bool pushed);

/// How far warp or weft is pushed together by the energy it has at a strain; at least that strain [-].
double rebound(const Fabric& fabric, double strain);

/// A fabric with linear laws as a file that outlives the program's scenes. @return its path
std::string writeFabric(const LinearFabric& linear);

/// writeFabric() of a fabric that hardly resists compression and bends, 10 μN·m.
std::string lightFabric();

std::string shippedFabric(const std::string& name);

/// A sheet as sheetScene() has it, with its fabric's file.
Torture tortureSheet(const std::string& name, const std::string& fabric_file, int warp, int weft,
                     double length, double width);

/// Runs a case and expects what its limits ask. A case that fails leaves a scene and the probes' ways in
/// $HAPTIC_CLOTH_TORTURE_OUT (default: torture_failures) and prints the command that replays it.
TortureResult torture(const Torture& wanted);

/// Files of a case: DIR/scene.yaml, DIR/fabric.yaml. @return path of the scene
std::string saveTorture(const Torture& wanted, const std::string& directory);

/// What a case measured, beside its limit, for the table in docs/stability.md: appended to
/// $HAPTIC_CLOTH_TORTURE_OUT/margins.csv where that is set.
/// @param unchecked why nothing is asked; empty: the limit is. It says something: it is finite
void recordMargin(const std::string& test_case, const std::string& criterion, double measured, double limit,
                  const std::string& unit, const std::string& unchecked = "");

/// How long a case goes on: what the environment variable says, else `short_form`, which is for every build.
double tortureLength(const char* variable, double short_form);

/// A capsule across the cloth's weft, as a hand would grip a strip's end.
ProbeOptions gripper(double length, double coupling_stiffness);

}  // namespace haptic_cloth
