/// The readers of files as functions of bytes that hold them to what they promise: for libFuzzer and for the
/// replay of its seeds.
#pragma once

#include <stdexcept>
#include <string>

namespace haptic_cloth {

/// What a reader must never do.
class BrokenPromise : public std::logic_error {
 public:
  using std::logic_error::logic_error;
};

/// Each reads `bytes` and returns, whatever they are. A refusal must be an InputError, one line of bounded
/// length that names the source and a rule; what is accepted must be what the solver may rely on: a scene
/// that passes validateScene(), laws that are finite, rise, and have their branches in order.
/// @return whether the bytes were accepted
/// @throws BrokenPromise if not so, or whatever else a reader let out
bool readSceneBytes(const std::string& bytes);
bool readFabricBytes(const std::string& bytes);

/// Each line of `bytes` is one `--set` on a scene that is good without them.
bool readOverrideBytes(const std::string& bytes);

}  // namespace haptic_cloth
