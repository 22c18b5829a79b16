// Table of the kernels of one instruction set.
#include "simd/kernels.h"

namespace haptic_cloth {
namespace HAPTIC_CLOTH_PATH {

extern const Kernels table;
const Kernels table = {
#define HAPTIC_CLOTH_ENTRY(result, name, arguments) &HAPTIC_CLOTH_PATH::name,
    HAPTIC_CLOTH_KERNELS(HAPTIC_CLOTH_ENTRY)
#undef HAPTIC_CLOTH_ENTRY
};

}  // namespace HAPTIC_CLOTH_PATH
}  // namespace haptic_cloth
