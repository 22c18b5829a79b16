#include "mesh/node_gather.h"
#include "simd/kernels.h"
#include "simd/point_lanes.h"

namespace haptic_cloth {
namespace HAPTIC_CLOTH_PATH {

void gatherColumns(const int* groups, const GatherColumn* columns, const GatherDetail* details, int begin,
                   int end, const double* slots, const MutableArrays& nodes) {
  constexpr int kChunk = kLanes >= 4 ? kPack : kPack / 2;  // nodes whose sums the registers hold
  for (int n = begin; n < end; n += kChunk) {
    const int group = n / kPack, within = n % kPack;
    Point sum[kChunk] = {};
    for (int c = groups[group]; c < groups[group + 1]; ++c) {
      const GatherColumn& column = columns[c];
      if (column.detail < 0) {
        const double* const first = slots + 4 * (column.first + within);
        for (int k = 0; k < kChunk; ++k) sum[k] = sum[k] + column.coefficient * loadPoint(first + 4 * k);
      } else {
        const GatherDetail& detail = details[column.detail];
        for (int k = 0; k < kChunk; ++k) {
          const Point slot = loadPoint(slots + 4 * detail.slots.index[within + k]);
          sum[k] = sum[k] + detail.coefficient[within + k] * slot;
        }
      }
    }
    for (int k = 0; k < kChunk; k += kLanes) {
      store(nodes, n + k, load(ConstArrays(nodes), n + k) + coordinates(sum + k));
    }
  }
}

}  // namespace HAPTIC_CLOTH_PATH
}  // namespace haptic_cloth
