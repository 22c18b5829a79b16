/// The reader of recordings as a function of bytes, beside those of readers.h.
#pragma once

#include <string>

namespace haptic_cloth {

/// Replays `bytes` on kTestedScene: a recording, or its lines after the header. The first three
/// steps are made. A refusal must be as in readers.h; input that is accepted must leave a scene that
/// passes validateScene() and a finite cloth.
/// @return whether the bytes were accepted
/// @throws BrokenPromise if a promise is broken; other exceptions of a reader pass through
bool readRecordingBytes(const std::string& bytes);

}  // namespace haptic_cloth
