/// Recordings and their replay.
/// Criterion: a replay ends with all bits of the recorded run; a recording that does not fit, is damaged or
/// cut off is told by its name and line.
#include "sim/recording.h"

#include <gtest/gtest.h>

#include <sstream>

#include "haptic_cloth/error.h"
#include "haptic_cloth/machine.h"
#include "support/state_cases.h"

namespace haptic_cloth::recording_test {
namespace {

/// Recording of a run of a case, with every kind of line.
std::string recordingOf(const StateCase& run, Simulation& simulation) {
  std::string text;
  simulation.record([&text](const std::string& line) { text += line + '\n'; });
  const Scene scene = run.scene;
  for (int step = 0; step < run.steps; ++step) {
    SolverOptions solver = scene.solver;
    AdaptOptions adapt = scene.adapt;
    if (step == 20) {
      solver.minimizer.tolerance = 1.0 / 3.0;
      adapt.interval = 6;
    }
    if (step == 20 || step == 40) simulation.setOptions(solver, adapt, scene.air_damping + 0.1 * step);
    if (step == 25) simulation.setCoupling(0, 300.0 / 7.0, 0.1);
    if (step == 45) simulation.reset();
    advance(run, simulation, step);
  }
  simulation.record(nullptr);
  return text;
}

/// Replays a recording. @return Replay::difference()
std::string replay(const std::string& text, Simulation& simulation) {
  std::istringstream stream(text);
  Replay replay(stream, "file", simulation);
  for (int length = 1; replay.next(simulation, length);) simulation.step(length);
  return replay.difference(simulation);
}

TEST(Recording, ReplaysToTheSameBits) {
  for (const StateCase& run : stateCases()) {
    SCOPED_TRACE(run.name);
    Simulation recorded(run.scene);
    const std::string text = recordingOf(run, recorded);
    Scene scene = run.scene;
    scene.solver.threads = 2;
    Simulation replayed(scene);
    EXPECT_EQ(replay(text, replayed), "");
    EXPECT_TRUE(replayed.saveState() == recorded.saveState());
  }
}

std::string messageOf(const std::string& text, const Scene& scene) {
  try {
    Simulation simulation(scene);
    return replay(text, simulation);
  } catch (const InputError& error) {
    return error.what();
  }
}

TEST(Recording, SaysWhatDoesNotFit) {
  const StateCase run = stateCases()[1];
  Simulation simulation(run.scene);
  const std::string text = recordingOf(run, simulation);
  const auto with = [&](const std::string& from, const std::string& to) {
    std::string changed = text;
    return changed.replace(changed.rfind(from), from.size(), to);
  };
  const auto expect = [&](const std::string& changed, const std::string& part) {
    const std::string message = messageOf(changed, run.scene);
    EXPECT_NE(message.find(part), std::string::npos) << message;
  };
  expect(text, "");
  EXPECT_EQ(messageOf(text, run.scene), "");
  expect("", "must be a recording");
  expect(with("recording 4", "recording 3"), "version = 3: must be 4");
  expect(text.substr(0, text.rfind("end")), "cut off");
  expect(with("step 3", "step 2"), "its replay with");
  expect(with("\nstep 3", "\nstep 0"), "must have a length");
  expect(with("\nstep 3", "\nstop"), "unknown word 'stop'");
  expect(with("device 0 ", "device 1 "), "is about probe 1, counted from 0; the scene has 1");
  expect(with("device 0 ", "device 0.5 "), "has '0.5' for the number of probe");
  expect(with("device 0 ", "device 0 x"), "for a number");
  expect(with("device 0 ", "device 0 nan "), "for a number");
  const std::string here = std::string("instructions ") + instructionSet();
  EXPECT_EQ(messageOf(with(here, "instructions other"), run.scene), "") << "only the end may differ there";
  expect(with("adapt.interval 6", "adapt.interval 0"), "adapt.interval");
  expect(with("adapt.interval", "adapt.levels"), "unknown option 'adapt.levels'");
  expect(with("\nreset", "\ndevice 0 1 2"), "too short");
  expect(with("\nreset", "\nreset 1"), "has '1' after its end");
  expect(text + "step 1\n", "follows the end");
  EXPECT_EQ(messageOf(text + "\n\n", run.scene), "");
  Scene other = run.scene;
  other.cloth.fabric.areal_density *= 2.0;
  EXPECT_NE(
      messageOf(text, other).find("file: cloth.fabric.areal_density = 0.2635: the scene here has 0.527; "),
      std::string::npos)
      << messageOf(text, other);
  other = run.scene;
  other.cloth.pose.position.x() += 1e-3;
  EXPECT_NE(messageOf(text, other).find("file: cloth.position = "), std::string::npos)
      << messageOf(text, other);
  other = run.scene;
  other.cloth.pins.clear();
  EXPECT_NE(messageOf(text, other).find("cloth.pins (how many) = "), std::string::npos)
      << messageOf(text, other);
  expect(with("scene cloth.size = ", "scene cloth.other = "), "cloth.other = ");
  expect(with("scene cloth.size = ", "scene cloth.size "), "must have the form");
  expect(with("scene cloth.size = ", "step 1"), "must be about the scene");
  expect(with("instructions ", "scene more = 1\ninstructions "),
         "more = 1: the scene here has no such entry");
  // Cut within its title, its scene, its steps and its end, and between them.
  for (const char* part : {"4\nscene", "scene cloth.size", "\nscene", "\nstep", "\ndevice", "\nend "})
    for (const int after : {1, 8}) expect(text.substr(0, text.rfind(part) + after), "cut off");
}

}  // namespace
}  // namespace haptic_cloth::recording_test
