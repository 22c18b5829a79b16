#include "energy/law_table.h"

#include <cmath>

namespace haptic_cloth {

LawTable::LawTable(const Loop& law) : kind_(law.hasMemory() ? LawView::Kind::Loop : LawView::Kind::Table) {
  const Curve& upper = law.upper();
  begin_ = upper.begin();
  inverse_step_ = upper.inverseStep();
  last_ = static_cast<double>(upper.intervals().size() - 1);
  if (kind_ == LawView::Kind::Table && joinLines(upper)) return;
  append(upper);
  if (kind_ == LawView::Kind::Table) return;
  append(law.path());
  append(law.lower());
}

/// Replaces the table by one or two lines, if the law consists of these. Most laws without memory
/// do.
/// @return whether this one does
bool LawTable::joinLines(const Curve& curve) {
  // Relative to the largest forces; far above the errors of their differences.
  constexpr double kRounding = 1e-12;
  const std::vector<Curve::Interval>& all = curve.intervals();
  if (all.size() == 1 && all.front().begin == 0.0 && all.front().force == 0.0) {
    append(curve);
    kind_ = LawView::Kind::Line;
    return true;
  }
  const double end = all.back().begin + 1.0 / inverse_step_, begin = all.front().begin;
  if (!(begin < 0.0) || !(end > 0.0)) return false;
  const double below = curve(begin).force / begin, above = curve(end).force / end;
  for (const Curve::Interval& interval : all) {
    const bool negative = interval.begin + 0.5 / inverse_step_ < 0.0;
    const double slope = negative ? below : above, largest = std::abs(above * end) + std::abs(below * begin);
    const double next = interval.begin + 1.0 / inverse_step_;
    if (std::abs(interval.force - slope * interval.begin) > kRounding * largest ||
        std::abs(interval.force + interval.slope / inverse_step_ - slope * next) > kRounding * largest) {
      return false;
    }
  }
  intervals_ = {{0.0, 0.0, below}, {0.0, 0.0, above}};
  kind_ = LawView::Kind::TwoLines;
  return true;
}

void LawTable::append(const Curve& curve) {
  for (const Curve::Interval& i : curve.intervals()) {
    const double q = i.force - i.slope * i.begin;
    intervals_.push_back({i.potential - i.begin * (i.force - 0.5 * i.slope * i.begin), q, i.slope});
  }
}

}  // namespace haptic_cloth
