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

class Probes {
 public:
  explicit Probes(int count);
  int count() const { return static_cast<int>(steps_.size()); }

  /// Tells whether a device is farther from its last position than a hand can move.
  bool jumps(int probe, const DeviceState& device, double time_step) const;

  /// Sets the device for the next step. The proxy of a probe that was absent starts at the device.
  /// @pre device is finite
  void setDevice(int probe, const DeviceState& device);
  void remove(int probe);

  /// Starts a step: probes turn towards their devices, no faster than a hand, and not so far that they could
  /// pass through cloth in the step. An open probe that lags catches up. The grip of one that holds cloth
  /// slips: if it caught up, it would do work that no hand had paid for.
  /// @param time_step length of the step [s]
  void beginStep(const std::vector<ProbeOptions>& probes, double time_step);
  /// Leaves a share of its turn in the step to a probe [-].
  void limitTurn(int probe, double share);

  void setClosed(int probe, bool closed);

  const std::vector<ProbeStep>& steps() const { return steps_; }  ///< input of the next step
  const std::vector<ProbeReport>& reports() const { return reports_; }
  bool isPresent(int probe) const { return steps_[probe].present; }
  bool isClosed(int probe) const { return memories_[probe].closed; }
  /// Orientation at the start and at the end of the step.
  const Quat& orientationBefore(int probe) const { return memories_[probe].before; }
  const Quat& orientation(int probe) const { return memories_[probe].after; }
  /// Tells whether it is present and its device turns it.
  bool turns(int probe) const;

  /// Places the present probes for a search of contacts. A probe that appears within the cloth
  /// touches nothing until it has been clear of it once.
  /// @param reach largest expected displacement of each proxy [m]
  /// @return probes that may touch the cloth; valid until the next call
  const std::vector<ContactSet::Reach>& findTouching(const ActiveMesh& mesh, const Field& nodes,
                                                     const std::vector<double>& reach, ContactSet& contacts);

  /// Takes the results of a solved step. @param made share of the motion that was made [-]
  void accept(double made, const ClothObjective& solved, const ContactSet& contacts, const ActiveMesh& mesh,
              const Grasps& grasps, ForceError& error);

  /// Ends a step whose solve failed: no motion, no force.
  void restore();

  /// Device and coupling of a probe at the end of a step.
  struct Coupled {
    Vec3 device = Vec3::Zero();  ///< position [m]
    double energy = 0.0;         ///< of the coupling; 0 for a probe that is absent [J]
  };

  /// Records the end of a step. @param energy of the coupling [J]
  /// @return what was recorded at the end of the one before; the device of a probe that has appeared since
  /// then is where it appeared
  Coupled replaceCoupling(int probe, double energy);

  void serialize(Archive& archive);

 private:
  /// State of a probe that is kept between steps.
  struct Memory {
    bool has_been_clear = false;     ///< of the cloth, since it appeared
    bool closed = false;             ///< holds the cloth that it touches
    Quat device = Quat::Identity();  ///< orientation of the device
    Quat slip = Quat::Identity();    ///< of the grip, in axes that turn with the device
    /// Orientation of the probe at the start and at the end of the current step.
    Quat before = Quat::Identity(), after = Quat::Identity();
    Coupled coupled;  ///< at the end of the last step

    /// Orientation to which the device turns the probe.
    Quat aim() const { return device * slip; }
    void serialize(Archive& archive);
  };

  Vec3 feltTorque(int probe, const Vec3& torque) const;

  std::vector<ProbeStep> steps_;
  std::vector<Memory> memories_;
  std::vector<ProbeReport> reports_;
  std::vector<ContactSet::Reach> touching_;
};

}  // namespace haptic_cloth
