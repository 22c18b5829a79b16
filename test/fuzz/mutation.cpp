#include "fuzz/mutation.h"

#include <algorithm>
#include <cctype>
#include <cmath>
#include <filesystem>
#include <fstream>
#include <iterator>

namespace haptic_cloth {
namespace {

namespace fs = std::filesystem;

const std::vector<std::string>& nastyWords() {
  static const std::vector<std::string> words{"[",
                                              "]",
                                              "{",
                                              "}",
                                              ": ",
                                              "- ",
                                              "? ",
                                              ", ",
                                              "\n",
                                              "\n  ",
                                              "\t",
                                              std::string(1, '\0'),
                                              "\r\n",
                                              "\xff",
                                              "\x80",
                                              "\xef\xbb\xbf",
                                              "&a ",
                                              "*a ",
                                              "*b",
                                              "!",
                                              "!!int ",
                                              "!!",
                                              "|\n",
                                              ">-",
                                              "\"",
                                              "'",
                                              "#",
                                              "---\n",
                                              "...\n",
                                              "%YAML 1.2\n",
                                              "<<: ",
                                              "~",
                                              "null",
                                              ".nan",
                                              "-.inf",
                                              "yes",
                                              "cloth:",
                                              "[[[[[",
                                              "a: &a [*a]\n",
                                              "probes: {a: {}, a: {}}\n",
                                              "\"\\x00\"",
                                              "../",
                                              "/dev/null",
                                              ".yaml",
                                              "="};
  return words;
}

const std::vector<std::string>& nastyNumbers() {
  static const std::vector<std::string> numbers{
      "0",      "-0",    "1",     "-1",     "2",           "3",           "0.5",  "1e-300", "1e300",
      "1e999",  "-1e99", "1e-12", "5e-324", "2147483647",  "-2147483648", "1e12", "1e-7",   "1e6",
      "1.0e+6", "65537", "00",    "0x10",   "99999999999", "+1",          "1.",   ".5",     "1e",
      "--1",    "1_000", ""};
  return numbers;
}

/// Begin and length of the first number at or after a random place in `text`; length 0: none.
std::pair<std::size_t, std::size_t> findNumber(const std::string& text, Dice& dice) {
  const std::size_t start = dice.below(text.size());
  const std::size_t begin = text.find_first_of("0123456789", start);
  if (begin == std::string::npos) return {0, 0};
  const std::size_t end = std::min(text.find_first_not_of("0123456789.eE+-", begin), text.size());
  return {begin, end - begin};
}

void changeNumber(std::string& text, Dice& dice) {
  const auto [begin, count] = findNumber(text, dice);
  if (count > 0) text.replace(begin, count, dice.choice(nastyNumbers()));
}

void change(std::string& text, const std::vector<Seed>& seeds, Dice& dice) {
  if (text.empty()) text = dice.choice(nastyWords());
  const std::size_t at = dice.below(text.size());
  const std::size_t length = 1 + dice.below(std::min<std::size_t>(text.size() - at, 24));
  switch (dice.below(9)) {
    case 0:
      text[at] = static_cast<char>(dice.below(256));
      break;
    case 1:
      text.erase(at, length);
      break;
    case 2:
      text.insert(at, text.substr(at, length));
      break;
    case 3:
      text.insert(at, dice.choice(nastyWords()));
      break;
    case 4:
      text.replace(at, length, dice.choice(nastyWords()));
      break;
    case 5: {
      const std::string& other = dice.choice(seeds).bytes;
      if (other.empty()) break;
      const std::size_t from = dice.below(other.size());
      text.insert(at, other.substr(from, 1 + dice.below(64)));
      break;
    }
    default:  // most often, so the text can usually be read to its end
      changeNumber(text, dice);
  }
}

}  // namespace

double Dice::logUniform(double least, double most) {
  return std::exp(uniform(std::log(least), std::log(most)));
}

std::vector<Seed> readSeeds(const std::vector<std::string>& folders) {
  std::vector<Seed> seeds;
  for (const std::string& folder : folders) {
    for (const auto& entry : fs::directory_iterator(fs::path(HAPTIC_CLOTH_SOURCE_DIR) / folder)) {
      std::ifstream stream(entry.path(), std::ios::binary);
      seeds.push_back({entry.path().string(),
                       {std::istreambuf_iterator<char>(stream), std::istreambuf_iterator<char>()}});
    }
  }
  std::sort(seeds.begin(), seeds.end(), [](const Seed& a, const Seed& b) { return a.file < b.file; });
  return seeds;
}

std::string mutated(const std::string& bytes, const std::vector<Seed>& seeds, Dice& dice) {
  std::string text = bytes;
  for (std::size_t changes = 1 + dice.below(4); changes > 0; --changes) change(text, seeds, dice);
  return text;
}

std::string withOtherNumbers(const std::string& text, Dice& dice) {
  std::string other = text;
  for (std::size_t changes = 1 + dice.below(3); changes > 0; --changes) changeNumber(other, dice);
  return other;
}

}  // namespace haptic_cloth
