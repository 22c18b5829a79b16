/// Memory aligned to cache lines: a register that crosses two lines takes twice as long to write.
#pragma once

#include <cstddef>
#include <new>
#include <vector>

namespace haptic_cloth {

template <class T>
struct CacheLineAllocator {
  using value_type = T;
  static constexpr std::align_val_t kLine{64};

  CacheLineAllocator() = default;
  template <class U>
  CacheLineAllocator(const CacheLineAllocator<U>&) {}  // conversion that allocators must have

  T* allocate(std::size_t count) { return static_cast<T*>(::operator new(count * sizeof(T), kLine)); }
  void deallocate(T* values, std::size_t) { ::operator delete(values, kLine); }
};

template <class T, class U>
bool operator==(const CacheLineAllocator<T>&, const CacheLineAllocator<U>&) {
  return true;
}
template <class T, class U>
bool operator!=(const CacheLineAllocator<T>&, const CacheLineAllocator<U>&) {
  return false;
}

/// Array that begins at a cache line.
using AlignedDoubles = std::vector<double, CacheLineAllocator<double>>;

}  // namespace haptic_cloth
