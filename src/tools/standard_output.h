/// Output of the tools.
#pragma once

namespace haptic_cloth {

/// Makes sure that all that was printed has reached standard output, which may be a file on a full
/// disk.
/// @throws OutputError
void requireStandardOutput();

}  // namespace haptic_cloth
