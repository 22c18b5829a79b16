/// Text of what a simulation is given, for recordings. The format is in docs/reference/recordings.md.
#pragma once

#include <istream>
#include <string>
#include <vector>

#include "haptic_cloth/simulation.h"
#include "scene/scene_options.h"

namespace haptic_cloth {

/// Lines without their ends. Numbers read back to the same bits.
namespace recorded {

std::string device(int probe, const DeviceState& device);
std::string removal(int probe);
std::string grasp(int probe, bool closed);
std::string obstacle(int obstacle, const Pose& target);
/// Those that differ. By value, as their rows point to members that could be written.
std::string options(StepOptions now, StepOptions changed);
std::string coupling(int probe, double stiffness, double damping);
std::string step(int length);
std::string reset();

/// First lines. @param start has made no step
std::vector<std::string> header(const Simulation& start);
/// Last line. @param end after the last step
std::string end(const Simulation& end);

}  // namespace recorded

/// A recording that is read and repeated.
class Replay {
 public:
  /// Reads the header. @param recording must outlive this object  @param origin its name in messages
  /// @throws InputError if it is not a recording, or one of another scene
  Replay(std::istream& recording, const std::string& origin, const Simulation& start);

  /// Repeats everything up to the next step, and tells how long that is. @return false at the end
  /// @throws InputError naming the line that cannot be read
  bool next(Simulation& simulation, int& length);

  /// Compares a simulation with the end of the recording. @pre next() was false
  /// @return how they differ; empty if they do not
  std::string difference(const Simulation& simulation) const;

 private:
  bool readLine(std::string& line);
  [[noreturn]] void fail(const std::string& rule) const;
  [[noreturn]] void refuseScene(const std::string& line, const std::string& here) const;
  template <class Call>
  void change(const Call& call) const;
  bool apply(Simulation& simulation, const std::string& line, int& length);

  std::istream& recording_;
  std::string origin_, instructions_, end_;
  long line_ = 0;
};

}  // namespace haptic_cloth
