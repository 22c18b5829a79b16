/// Array whose memory is only taken when it is written.
#pragma once

#include <cstddef>
#include <cstdlib>
#include <memory>
#include <new>
#include <type_traits>

namespace haptic_cloth {

/// Fixed number of values, all zero at first. Pages of a large array that were never written take
/// no memory.
template <class T>
class Zeros {
  static_assert(std::is_trivially_copyable_v<T>, "zero bytes must be a value");

 public:
  explicit Zeros(std::size_t count) : values_(static_cast<T*>(std::calloc(count, sizeof(T)))) {
    if (!values_ && count > 0) throw std::bad_alloc();
  }

  T& operator[](std::size_t k) { return values_[k]; }
  T* data() { return values_.get(); }

 private:
  struct Free {
    void operator()(T* values) const { std::free(values); }
  };
  std::unique_ptr<T[], Free> values_;
};

}  // namespace haptic_cloth
