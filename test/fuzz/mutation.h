/// Seeds and their mutations: a mutator without libFuzzer, with equal results on every machine.
#pragma once

#include <cstdint>
#include <random>
#include <string>
#include <vector>

namespace haptic_cloth {

/// A file from which mutations start.
struct Seed {
  std::string file;
  std::string bytes;
};

/// Files in `folders` below the source tree, ordered by name.
std::vector<Seed> readSeeds(const std::vector<std::string>& folders);

/// Random numbers and choices from one engine. The distributions of the standard library are not
/// used, because they differ between implementations.
class Dice {
 public:
  explicit Dice(std::uint64_t seed) : engine_(seed) {}

  /// 0 .. count - 1. @pre count > 0
  std::size_t below(std::size_t count) { return static_cast<std::size_t>(engine_() % count); }
  int within(int least, int most) {
    return least + static_cast<int>(below(static_cast<std::size_t>(most - least) + 1));
  }
  double uniform(double least, double most) {
    return least + (most - least) * (static_cast<double>(engine_() >> 11) * 0x1p-53);
  }
  double logUniform(double least, double most);
  bool chance(double probability) { return uniform(0.0, 1.0) < probability; }
  template <class T>
  const T& choice(const std::vector<T>& of) {
    return of[below(of.size())];
  }

 private:
  std::mt19937_64 engine_;
};

/// `bytes` after one to four changes: bytes changed, removed, doubled or replaced by a word that is
/// difficult to read, a number replaced by another, or a piece of another seed inserted.
std::string mutated(const std::string& bytes, const std::vector<Seed>& seeds, Dice& dice);

/// `text` with one to three of its numbers replaced by others that are rare in files.
std::string withOtherNumbers(const std::string& text, Dice& dice);

}  // namespace haptic_cloth
