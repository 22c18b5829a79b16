/// Probes of a scene: input of their devices, memory between steps, reports.
#pragma once

#include <vector>

#include "contact/contact_set.h"
#include "haptic_cloth/report.h"
#include "sim/probe_step.h"
#include "state/archive.h"

namespace haptic_cloth {

class ClothObjective;
class ForceError;
class Grasps;

/// Devices, proxies and reports of all probes of a scene.
class Probes {
 public:
  /// @param scene must outlive this object
  explicit Probes(const Scene& scene);
  int count() const { return static_cast<int>(steps_.size()); }

  /// Tells whether a device has moved, or turned a probe, farther than a hand can.
  bool jumps(int probe, const DeviceState& device, double time_step) const;

  /// Sets the device for the next step. The proxy of a probe that was absent starts at the device.
  /// @pre device is finite
  void setDevice(int probe, const DeviceState& device);
  void remove(int probe);

  /// Starts a step. The couplings turn capsules and closed probes towards their devices. An open sphere is
  /// the same from all sides: it turns with its device. With the joint cost, only that turns.
  /// @param time_step length of the step [s]
  void beginStep(double time_step);

  void setClosed(int probe, bool closed);

  const std::vector<ProbeStep>& steps() const { return steps_; }  ///< input of the next step
  const std::vector<ProbeReport>& reports() const { return reports_; }
  bool isPresent(int probe) const { return steps_[probe].present; }
  bool isClosed(int probe) const { return memories_[probe].closed; }
  /// Orientation at the start of the step.
  const Quat& orientation(int probe) const { return steps_[probe].orientation; }
  /// Angular velocity in the last step, if its turn was solved for [rad/s].
  const Vec3& spin(int probe) const { return memories_[probe].spin; }
  /// Largest speed by a turn in the last step, at the radius of turnRadiusSquared() [m/s].
  double fastestTurn() const;
  /// Tells whether it is an open sphere that has not yet the orientation of its device.
  bool turnsAsPrescribed(int probe) const;

  /// Places the present probes for a search of contacts. A probe that appears within the cloth
  /// touches nothing until it has been clear of it once.
  /// @param reach largest expected displacement of any point of each probe [m]
  /// @return probes that may touch the cloth; valid until the next call
  const std::vector<ContactSet::Reach>& findTouching(const ActiveMesh& mesh, const Field& nodes,
                                                     const std::vector<double>& reach, ContactSet& contacts);

  /// Takes the results of a solved step.
  void accept(const ClothObjective& solved, const ContactSet& contacts, const ActiveMesh& mesh,
              const Grasps& grasps, ForceError& error);

  /// Ends a step whose solve failed: no motion, no force.
  void restore();

  /// Device and coupling of a probe at the end of a step.
  struct Coupled {
    Vec3 device = Vec3::Zero();           ///< position [m]
    Quat orientation = Quat::Identity();  ///< of the device
    double energy = 0.0;                  ///< of the coupling; 0 for a probe that is absent [J]
  };

  /// Records the end of a step. @param energy of the coupling [J]
  /// @return what was recorded at the end of the one before; the device of a probe that has appeared since
  /// then is where it appeared
  Coupled replaceCoupling(int probe, double energy);

  void serialize(Archive& archive);

 private:
  /// State of a probe that is kept between steps.
  struct Memory {
    bool has_been_clear = false;  ///< of the cloth, since it appeared
    bool closed = false;          ///< holds the cloth that it touches
    Vec3 spin = Vec3::Zero();     ///< see spin() [rad/s]
    Coupled coupled;              ///< at the end of the last step

    void serialize(Archive& archive);
  };

  bool isOpenSphere(int probe) const { return !scene_.probes[probe].isTurned(isClosed(probe)); }

  const Scene& scene_;
  std::vector<ProbeStep> steps_;
  std::vector<Memory> memories_;
  std::vector<ProbeReport> reports_;
  std::vector<ContactSet::Reach> touching_;
};

}  // namespace haptic_cloth
