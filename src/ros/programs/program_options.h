/// Private parameters of the programs beside the node, and their rows. Units and meanings stand in the
/// rows (program_options.cpp).
#pragma once

#include <string>
#include <utility>
#include <vector>

#include "haptic_cloth/types.h"
#include "scene/option.h"

namespace haptic_cloth {

/// Intended motion of the hand and properties of the arm. The defaults fit demo.yaml and
/// box_drape.yaml in config/scenes. Their draped top lies at about z = 0.055 m, so the probe's
/// centre first touches it at about 0.063 m.
struct HandOptions {
  Vec3 start{-0.03, 0.0, 0.14};
  Vec3 press{-0.03, 0.0, 0.050};
  Vec3 slide{0.06, 0.0, 0.0};
  double delay = 2.0;
  double approach_time = 1.5;
  double hold_time = 0.5;
  double slide_time = 2.0;
  double lift_time = 1.0;
  double mass = 0.1;
  double stiffness = 300.0;
  double damping = 8.0;
  double rate = 1000.0;
  std::string frame_id = "world";
};

struct MouseHandOptions {
  std::string node = "haptic_cloth";
  double rate = 125.0;
  double time_constant = 0.03;
};

struct PathHandOptions {
  std::string node = "haptic_cloth";
  double rate = 1000.0;
  double repeat_after = 0.0;
};

struct MonitorOptions {
  std::string node = "haptic_cloth";
  double seconds = 0.0;
  double patience = 30.0;
  double reaction_rate = 900.0;
  double display_rate = 20.0;
};

struct GraspButtonOptions {
  int number = 0;
};

struct LatencyProbeOptions {
  std::string node = "/haptic_cloth", out;
  bool nodelet = false;
  double hang = 1.0;
  int seconds = 30;
};

std::vector<OptionGroup> groupsOf(HandOptions& hand);
std::vector<OptionGroup> groupsOf(MouseHandOptions& hand);
std::vector<OptionGroup> groupsOf(PathHandOptions& hand);
std::vector<OptionGroup> groupsOf(MonitorOptions& monitor);
std::vector<OptionGroup> groupsOf(GraspButtonOptions& button);
std::vector<OptionGroup> groupsOf(LatencyProbeOptions& probe);

/// Tables of the reference, with the names of the programs.
std::vector<std::pair<std::string, std::string>> programTables();

}  // namespace haptic_cloth
