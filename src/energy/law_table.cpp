#include "energy/law_table.h"

namespace haptic_cloth {

LawTable::LawTable(const Loop& law) : memory_(law.hasMemory()) {
  const Curve& upper = law.upper();
  begin_ = upper.begin();
  inverse_step_ = upper.inverseStep();
  last_ = static_cast<double>(upper.intervals().size() - 1);
  append(upper);
  if (!memory_) return;
  append(law.path());
  append(law.lower());
}

void LawTable::append(const Curve& curve) {
  for (const Curve::Interval& i : curve.intervals()) {
    const double q = i.force - i.slope * i.begin;
    intervals_.push_back({i.potential - i.begin * (i.force - 0.5 * i.slope * i.begin), q, i.slope});
  }
}

}  // namespace haptic_cloth
