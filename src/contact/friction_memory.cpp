#include "contact/friction_memory.h"

#include <algorithm>
#include <climits>
#include <cmath>

namespace haptic_cloth {
void FrictionMemory::clear() {
  for (const Entry& entry : entries_) firstIn(entry.u, entry.v) = kNone;
  entries_.clear();
  widest_ = 0.0;
}

int& FrictionMemory::firstIn(double u, double v) {
  return first_[grid_.particle(static_cast<int>(u), static_cast<int>(v))];
}

void FrictionMemory::add(int solid, const FlatPoint& at, double half, const Vec3& friction) {
  entries_.push_back({solid, at.u, at.v, half, friction});
  link(static_cast<int>(entries_.size()) - 1);
}

void FrictionMemory::link(int entry) {
  int& first = firstIn(entries_[entry].u, entries_[entry].v);
  entries_[entry].next = first;
  first = entry;
  widest_ = std::max(widest_, entries_[entry].half);
}

Vec3 FrictionMemory::find(int solid, const FlatPoint& at) const {
  constexpr double kSame = 1e-6;  // [finest cells]
  const auto entriesIn = [&](int i, int j, const auto& visit) {
    for (int k = first_[grid_.particle(i, j)]; k != kNone; k = entries_[k].next) {
      if (entries_[k].solid == solid) visit(entries_[k]);
    }
  };
  const auto distance = [&](const Entry& entry) {
    return std::max(std::abs(entry.u - at.u), std::abs(entry.v - at.v));
  };
  const Entry* nearest = nullptr;
  double least = kSame;
  const auto compare = [&](const Entry& entry) {
    const double apart = distance(entry);
    if (apart > least || apart > std::max(entry.half, kSame)) return;
    least = apart;
    nearest = &entry;
  };
  entriesIn(static_cast<int>(at.u), static_cast<int>(at.v), compare);
  if (nearest == nullptr && widest_ > 0.0) {
    least = widest_;
    const int left = std::max(0, static_cast<int>(at.u - widest_)),
              right = std::min(grid_.columns - 1, static_cast<int>(at.u + widest_)),
              low = std::max(0, static_cast<int>(at.v - widest_)),
              high = std::min(grid_.rows - 1, static_cast<int>(at.v + widest_));
    for (int j = low; j <= high; ++j) {
      for (int i = left; i <= right; ++i) entriesIn(i, j, compare);
    }
  }
  return nearest != nullptr ? nearest->friction : Vec3::Zero();
}

void FrictionMemory::serialize(Archive& archive, int solids) {
  if (archive.loads()) clear();
  archive.length("samples", entries_, INT_MAX);
  archive.each("solid", entries_, &Entry::solid);
  archive.each("u", entries_, &Entry::u);
  archive.each("v", entries_, &Entry::v);
  archive.each("half", entries_, &Entry::half);
  archive.each("friction", entries_, &Entry::friction);
  if (!archive.loads()) return;
  const double widest = std::max(grid_.columns, grid_.rows);
  for (int k = 0; k < static_cast<int>(entries_.size()); ++k) {
    const Entry& entry = entries_[k];
    const bool inside = entry.solid >= 0 && entry.solid < solids && entry.u >= 0.0 &&
                        entry.u <= grid_.columns - 1 && entry.v >= 0.0 && entry.v <= grid_.rows - 1 &&
                        entry.half >= 0.0 && entry.half <= widest;
    if (!inside) entries_.resize(k);  // clear() must find only entries that are linked
    archive.check(inside, "samples", "must lie on the cloth and on a solid");
    link(k);
  }
}

}  // namespace haptic_cloth
