/// Named entries of a state, saved and loaded by the same code: each class names its members once,
/// so that saving and loading cannot diverge.
#pragma once

#include <cstddef>
#include <cstdint>
#include <string>
#include <type_traits>
#include <utility>
#include <vector>

#include "haptic_cloth/types.h"

namespace haptic_cloth {

/// Entries in the order in which they are named. Each has its name, type, length and its bytes as
/// in memory, so a loaded value equals the saved one bit for bit. Loading checks names, types,
/// lengths and that every double is finite; classes check the rest.
class Archive {
 public:
  /// Archive for saving.
  Archive() = default;

  /// Archive for loading the result of sealed().
  /// @param origin name of the source in messages
  /// @throws InputError if it is incomplete, or of another version or byte order
  Archive(const std::string& sealed, std::string origin);

  /// Checks the header of a sealed state before the rest is read.
  /// @param start its first headerSize() bytes, or all of it if it is shorter
  /// @param size size of the whole state [bytes]
  /// @throws InputError as the constructor, except for the checksum and the entries
  static void checkHeader(const std::string& start, std::uint64_t size, const std::string& origin);
  static std::size_t headerSize();

  bool loads() const { return loads_; }

  /// All entries with a header that shows whether they are complete. @pre this archive saves
  std::string sealed() const;

  /// Name and value of each entry, for people: of more than eight numbers, their hash.
  /// @pre this archive saves
  std::vector<std::pair<std::string, std::string>> texts() const;

  /// Saves or loads an entry: a number, an Eigen object of doubles, or a vector of these whose
  /// length must match. Also an object with serialize(Archive&), or a vector of such objects.
  /// @throws InputError if the loaded entry does not fit
  template <class T>
  void operator()(const std::string& name, T& value) {
    if constexpr (std::is_same_v<T, bool>) {
      char kept = value ? 1 : 0;
      within(name, kept, 0, 1);
      value = kept != 0;
    } else if constexpr (Serialized<T>::value) {
      const std::string outer = prefix_;
      prefix_ += name + ".";
      value.serialize(*this);
      prefix_ = outer;
    } else if constexpr (Listed<T>::value) {
      list(name, value);
    } else {
      entry(name, typeOf<T>(), &value, sizeof(T) / sizeOf(typeOf<T>()));
    }
    if constexpr (std::is_same_v<T, Quat>) check(isRotation(value), name, "must have norm 1");
  }

  /// Saves or loads integers that must lie between low and high: one, or a vector of them.
  template <class T>
  void within(const std::string& name, T& value, long low, long high) {
    (*this)(name, value);
    bool inside = true;
    if constexpr (Listed<T>::value) {
      for (const auto& number : value) inside = inside && low <= number && number <= high;
    } else {
      inside = low <= value && value <= high;
    }
    check(inside, name, "must be from " + std::to_string(low) + " to " + std::to_string(high));
  }

  /// Saves or loads one member of all elements, as one entry.
  template <class T, class Member>
  void each(const std::string& name, std::vector<T>& elements, Member T::*member) {
    // vector<bool> has no addressable elements.
    using Kept = std::conditional_t<std::is_same_v<Member, bool>, char, Member>;
    std::vector<Kept> values;
    values.reserve(elements.size());
    for (const T& element : elements) values.push_back(element.*member);
    if constexpr (std::is_same_v<Member, bool>) {
      within(name, values, 0, 1);
    } else {
      (*this)(name, values);
    }
    if constexpr (std::is_same_v<Member, Quat>) {
      for (const Member& turn : values) check(isRotation(turn), name, "must have norm 1");
    }
    for (std::size_t k = 0; k < elements.size(); ++k) elements[k].*member = static_cast<Member>(values[k]);
  }

  /// Saves the length of a vector whose elements follow, or resizes the vector on loading: to no more than
  /// the bytes that are left. @param most largest length allowed
  template <class T>
  void length(const std::string& name, std::vector<T>& elements, std::size_t most) {
    long size = static_cast<long>(elements.size());
    within(name, size, 0, static_cast<long>(most));
    check(static_cast<std::size_t>(size) <= entries_.size() - at_, name, "must not exceed what follows");
    elements.resize(size);
  }

  /// Saves or loads `count` consecutive doubles.
  void doubles(const std::string& name, double* first, std::size_t count) {
    entry(name, Type::Double, first, count);
  }

  /// Saves a value that the state depends on, or compares it on loading. @throws InputError if it
  /// differs
  void same(const std::string& name, double value) { compare(name, Type::Double, &value, 1); }
  void same(const std::string& name, int value) { compare(name, Type::Int, &value, 1); }
  void same(const std::string& name, const std::string& value) {
    compare(name, Type::Byte, value.data(), value.size());
  }
  void same(const std::string& name, const double* first, std::size_t count) {
    compare(name, Type::Double, first, count);
  }

  /// Same for computed values, with a tolerance of 1e-9 of the largest: other machines may round
  /// differently. What is saved is rounded, too.
  void similar(const std::string& name, const std::vector<double>& values);

  /// @throws InputError when loading, if not `right`
  void check(bool right, const std::string& name, const std::string& rule) const {
    if (loads_ && !right) fail(name, "", rule);
  }

  /// Must be called last. @throws InputError if there are entries that were not loaded
  void finish() const;

 private:
  enum class Type : char { Byte = 'b', Int = 'i', Long = 'l', Double = 'd' };

  struct Header {
    Type type;
    std::size_t count;
    std::size_t begin;  ///< offset of its bytes
  };

  template <class T, class = void>
  struct Serialized : std::false_type {};
  template <class T>
  struct Serialized<T, std::void_t<decltype(std::declval<T&>().serialize(std::declval<Archive&>()))>>
      : std::true_type {};
  template <class T>
  struct Listed : std::false_type {};
  template <class T>
  struct Listed<std::vector<T>> : std::true_type {};

  template <class T, class = void>
  struct OfDoubles : std::is_same<T, double> {};
  template <class T>
  struct OfDoubles<T, std::void_t<typename T::Scalar>> : std::is_same<typename T::Scalar, double> {};

  template <class T>
  static constexpr Type typeOf() {
    if constexpr (std::is_same_v<T, int>) {
      return Type::Int;
    } else if constexpr (std::is_same_v<T, long>) {
      return Type::Long;
    } else if constexpr (std::is_arithmetic_v<T> && !std::is_same_v<T, double>) {
      static_assert(sizeof(T) == 1, "only int, long, double and bytes are saved");
      return Type::Byte;
    } else {
      static_assert(OfDoubles<T>::value, "no entry");
      return Type::Double;
    }
  }

  static std::size_t sizeOf(Type type);

  template <class T>
  void list(const std::string& name, std::vector<T>& values) {
    if constexpr (Serialized<T>::value) {
      for (std::size_t k = 0; k < values.size(); ++k)
        (*this)(name + "[" + std::to_string(k) + "]", values[k]);
    } else {
      constexpr Type kType = typeOf<T>();
      entry(name, kType, values.data(), values.size() * (sizeof(T) / sizeOf(kType)));
    }
  }

  void entry(const std::string& name, Type type, void* data, std::size_t count);
  void compare(const std::string& name, Type type, const void* data, std::size_t count);
  void write(const std::string& name, Type type, const void* data, std::size_t count);
  const char* take(std::size_t& at, std::size_t size, const std::string& wanted) const;
  std::string takeName(std::size_t& at, const std::string& wanted) const;
  Header takeHeader(std::size_t& at, const std::string& wanted) const;
  Header read(const std::string& name);
  std::string text(Type type, const char* bytes, std::size_t count) const;
  [[noreturn]] void fail(const std::string& name, const std::string& value, const std::string& rule) const;
  [[noreturn]] void differs(const std::string& name, const Header& found, const std::string& here) const;

  bool loads_ = false;
  std::string entries_, origin_, prefix_;
  std::size_t at_ = 0;  ///< offset of the next entry
};

}  // namespace haptic_cloth
