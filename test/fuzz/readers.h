/// The readers of files as functions of bytes that check what the readers promise. Used by
/// libFuzzer and by the replay of its seeds.
#pragma once

#include <functional>
#include <stdexcept>
#include <string>

namespace haptic_cloth {

/// Thrown if a reader breaks its promise.
class BrokenPromise : public std::logic_error {
 public:
  using std::logic_error::logic_error;
};

/// Each function reads `bytes`, whatever they are. A refusal must be an InputError: one line of
/// limited length that names the source and a rule. Accepted input must be what the solver relies
/// on: a scene that passes validateScene(); laws that are finite, do not fall, and have their
/// branches in order.
/// @return whether the bytes were accepted
/// @throws BrokenPromise if a promise is broken; other exceptions of a reader pass through
bool readSceneBytes(const std::string& bytes);
bool readFabricBytes(const std::string& bytes);

/// Each line of `bytes` is one `--set` for kTestedScene.
bool readOverrideBytes(const std::string& bytes);

/// Scene that is valid as it stands, with two probes and two obstacles.
extern const char kTestedScene[];

/// Source that messages must name.
constexpr char kOrigin[] = "input.yaml";

/// Runs a reader and checks its refusal. @return whether it accepted
bool accepts(const std::function<void()>& read);

}  // namespace haptic_cloth
