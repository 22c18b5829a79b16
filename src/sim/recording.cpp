#include "sim/recording.h"

#include <cctype>
#include <climits>
#include <cmath>
#include <cstdio>
#include <locale>
#include <optional>
#include <sstream>
#include <vector>

#include "haptic_cloth/error.h"
#include "haptic_cloth/machine.h"
#include "scene/scene_identity.h"
#include "state/archive.h"
#include "state/number_text.h"

namespace haptic_cloth {
namespace {

constexpr char kName[] = "haptic_cloth recording ", kVersion[] = "4";
constexpr char kScene[] = "scene ", kEquals[] = " = ";
constexpr char kCutOff[] = "has no end: it is cut off";

std::string join(const char* word, int number, std::initializer_list<const double*> vectors,
                 std::initializer_list<int> sizes) {
  std::string line = std::string(word) + ' ' + std::to_string(number);
  auto size = sizes.begin();
  for (const double* vector : vectors) {
    for (int c = 0; c < *size; ++c) line += ' ' + shortestText(vector[c]);
    ++size;
  }
  return line;
}

/// Lines "scene KEY = VALUE" of everything in the scene of a new simulation that a state must fit, and of
/// its start. They are the same on each instruction set.
std::vector<std::string> sceneLines(const Simulation& start) {
  Archive archive;
  serializeIdentity(archive, start.scene());
  std::vector<Vec3> positions;
  start.positions(positions);
  std::vector<double> start_positions;
  for (const Vec3& x : positions) start_positions.insert(start_positions.end(), x.data(), x.data() + 3);
  archive.similar("positions", start_positions);
  archive.same("active", start.activeParticles());
  std::vector<std::string> lines;
  for (const auto& [key, value] : archive.texts()) {
    lines.push_back(kScene + key + kEquals + value);
    // A name may hold the end of a line.
    for (char& c : lines.back()) {
      if (std::iscntrl(static_cast<unsigned char>(c)) != 0) c = '?';
    }
  }
  return lines;
}

}  // namespace

namespace recorded {

std::string device(int probe, const DeviceState& device) {
  return join(
      "device", probe,
      {device.position.data(), device.velocity.data(), device.orientation.coeffs().data(), &device.elapsed},
      {3, 3, 4, 1});
}

std::string removal(int probe) { return "remove " + std::to_string(probe); }

std::string grasp(int probe, bool closed) {
  return "grasp " + std::to_string(probe) + (closed ? " closed" : " open");
}

std::string obstacle(int obstacle, const Pose& target) {
  return join("obstacle", obstacle, {target.position.data(), target.orientation.coeffs().data()}, {3, 4});
}

std::string options(StepOptions now, StepOptions changed) {
  const Options rows = optionsOf(now), next = optionsOf(changed);
  std::string line = "options";
  for (std::size_t k = 0; k < next.size(); ++k) {
    const std::string value = valueText(next[k]);
    if (value != valueText(rows[k])) line += ' ' + next[k].key + ' ' + value;
  }
  return line;
}

std::string coupling(int probe, double stiffness, double damping) {
  return join("coupling", probe, {&stiffness, &damping}, {1, 1});
}

std::string step(int length) { return "step " + std::to_string(length); }

std::string reset() { return "reset"; }

std::vector<std::string> header(const Simulation& start) {
  std::vector<std::string> lines = sceneLines(start);
  lines.insert(lines.begin(), std::string(kName) + kVersion);
  lines.push_back(std::string("instructions ") + instructionSet());
  return lines;
}

std::string end(const Simulation& end) { return "end " + hexadecimalText(end.stateHash()); }

}  // namespace recorded

Replay::Replay(std::istream& recording, const std::string& origin, const Simulation& start)
    : recording_(recording), origin_(origin) {
  std::string title;
  std::getline(recording, title);
  line_ = 1;
  if (title.rfind(kName, 0) != 0)
    throw InputError(origin, "", "", "must be a recording: it does not begin as one");
  if (recording.eof()) fail(kCutOff);
  const std::string version = title.substr(sizeof(kName) - 1);
  if (version != kVersion)
    throw InputError(origin, "version", version,
                     std::string("must be ") + kVersion + ", that of this program");
  std::string line;
  const auto next = [&] {
    if (!readLine(line)) throw InputError(origin, "", "", kCutOff);
  };
  next();
  for (const std::string& here : sceneLines(start)) {
    if (line != here) refuseScene(line, here);
    next();
  }
  if (line.rfind(kScene, 0) == 0) refuseScene(line, "");
  const std::string word = "instructions ";
  if (line.rfind(word, 0) != 0) fail("must name the instructions");
  instructions_ = line.substr(word.size());
}

/// @return false at the end of the recording
bool Replay::readLine(std::string& line) {
  if (!std::getline(recording_, line)) return false;
  ++line_;
  if (recording_.eof()) fail(kCutOff);
  return true;
}

/// Names the first line about the scene that differs. @param here that of the scene at hand
void Replay::refuseScene(const std::string& line, const std::string& here) const {
  if (line.rfind(kScene, 0) != 0) fail("must be about the scene");
  const std::string found = line.substr(sizeof(kScene) - 1);
  const std::size_t equals = found.find(kEquals);
  if (equals == std::string::npos) fail("must have the form 'scene KEY = VALUE'");
  const std::string start = line.substr(0, line.find(kEquals) + sizeof(kEquals) - 1);
  const bool has_key = here.rfind(start, 0) == 0;
  throw InputError(origin_, found.substr(0, equals), found.substr(equals + sizeof(kEquals) - 1),
                   "the scene here has " + (has_key ? here.substr(start.size()) : "no such entry") +
                       "; take the scene of the recording, and repeat the parameters of the node with --set");
}

bool Replay::next(Simulation& simulation, int& length) {
  for (std::string line; readLine(line);) {
    if (line.rfind("end ", 0) == 0) {
      end_ = line.substr(4);
      while (readLine(line)) {
        if (!line.empty()) fail("follows the end of the recording");
      }
      return false;
    }
    if (apply(simulation, line, length)) return true;
  }
  return false;
}

/// Makes a change that the simulation may refuse.
template <class Call>
void Replay::change(const Call& call) const {
  try {
    call();
  } catch (const InputError& error) {
    fail(error.what());
  }
}

/// Repeats one line. @return whether it is a step, which is left to the caller
bool Replay::apply(Simulation& simulation, const std::string& line, int& length) {
  std::istringstream text(line);
  text.imbue(std::locale::classic());
  std::string word;
  text >> word;
  const auto numbers = [&](double* first, int count) {
    std::string number;
    for (int c = 0; c < count; ++c) {
      if (!(text >> number)) fail("is too short");
      const std::optional<double> value = readNumber(number);
      if (!value) fail("has '" + number + "' for a number");
      first[c] = *value;
    }
  };
  const auto index = [&](const std::string& kind, std::size_t count) {
    double number = 0.0;
    numbers(&number, 1);
    const std::string whole = shortestText(number);
    if (number != std::floor(number)) fail("has '" + whole + "' for the number of " + kind);
    if (number < 0.0 || number >= static_cast<double>(count))
      fail("is about " + kind + " " + whole + ", counted from 0; the scene has " + std::to_string(count));
    return static_cast<int>(number);
  };
  const Scene& scene = simulation.scene();
  if (word == "step") {
    if (!(text >> length) || length < 1 || length > INT_MAX / 2) fail("must have a length of at least 1");
  } else if (word == "device") {
    const int probe = index("probe", scene.probes.size());
    DeviceState device;
    numbers(device.position.data(), 3);
    numbers(device.velocity.data(), 3);
    numbers(device.orientation.coeffs().data(), 4);
    numbers(&device.elapsed, 1);
    simulation.setDevice(probe, device);
  } else if (word == "remove") {
    simulation.removeDevice(index("probe", scene.probes.size()));
  } else if (word == "grasp") {
    const int probe = index("probe", scene.probes.size());
    text >> word;
    if (word != "closed" && word != "open") fail("has '" + word + "' for closed or open");
    simulation.setGrasp(probe, word == "closed");
  } else if (word == "obstacle") {
    const int obstacle = index("obstacle", scene.obstacles.size());
    Pose target;
    numbers(target.position.data(), 3);
    numbers(target.orientation.coeffs().data(), 4);
    simulation.moveObstacle(obstacle, target);
  } else if (word == "coupling") {
    const int probe = index("probe", scene.probes.size());
    double stiffness = 0.0, damping = 0.0;
    numbers(&stiffness, 1);
    numbers(&damping, 1);
    change([&] { simulation.setCoupling(probe, stiffness, damping); });
  } else if (word == "options") {
    StepOptions changed = stepOptions(scene);
    const Options rows = optionsOf(changed);
    for (std::string key; text >> key;) {
      double value = 0.0;
      numbers(&value, 1);
      bool known = false;
      for (const Option& option : rows) {
        if (!option.live || option.key != key) continue;
        known = true;
        if (const auto* number = std::get_if<Numbers<double>>(&option.field)) *number->first = value;
        if (const auto* whole = std::get_if<Numbers<int>>(&option.field)) {
          if (!(std::abs(value) <= INT_MAX) || value != std::floor(value)) {
            fail("has '" + key + "' without a whole number");
          }
          *whole->first = static_cast<int>(value);
        }
      }
      if (!known) fail("has the unknown option '" + key + "'");
    }
    change([&] { simulation.setOptions(changed.solver, changed.adapt, changed.air_damping); });
  } else if (word == "reset") {
    simulation.reset();
  } else {
    fail("begins with the unknown word '" + word + "'");
  }
  if (std::string rest; text >> rest) fail("has '" + rest + "' after its end");
  return word == "step";
}

std::string Replay::difference(const Simulation& simulation) const {
  if (end_.empty()) return origin_ + ": " + kCutOff;
  const std::string hash = hexadecimalText(simulation.stateHash());
  if (hash == end_) return "";
  return origin_ + ": ends with the state " + end_ + " (" + instructions_ + "), its replay with " + hash +
         " (" + instructionSet() + ")";
}

void Replay::fail(const std::string& rule) const {
  throw InputError(origin_ + ":" + std::to_string(line_), "", "", rule);
}

}  // namespace haptic_cloth
