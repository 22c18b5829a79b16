#include "mesh/node_gather.h"
#include "simd/kernels.h"
#include "simd/lanes.h"

namespace haptic_cloth {
namespace HAPTIC_CLOTH_PATH {

void gatherColumns(const int* groups, const GatherColumn* columns, const GatherDetail* details, int begin,
                   int end, const ConstArrays& slots, const MutableArrays& nodes) {
  constexpr int kParts = kPack / kLanes;
  for (int n = begin; n < end; n += kPack) {
    const int group = n / kPack;
    Lanes3 sum[kParts];
    for (int k = 0; k < kParts; ++k) sum[k] = load(ConstArrays(nodes), n + k * kLanes);
    for (int c = groups[group]; c < groups[group + 1]; ++c) {
      const GatherColumn& column = columns[c];
      if (column.detail < 0) {
        const Lanes coefficient = all(column.coefficient);
        for (int k = 0; k < kParts; ++k) {
          sum[k] = sum[k] + coefficient * load(slots, column.first + k * kLanes);
        }
      } else {
        const GatherDetail& detail = details[column.detail];
        for (int k = 0; k < kParts; ++k) {
          const Lanes coefficient = load(detail.coefficient + k * kLanes);
          sum[k] = sum[k] + coefficient * gather(slots, detail.slots, k * kLanes);
        }
      }
    }
    for (int k = 0; k < kParts; ++k) store(nodes, n + k * kLanes, sum[k]);
  }
}

}  // namespace HAPTIC_CLOTH_PATH
}  // namespace haptic_cloth
