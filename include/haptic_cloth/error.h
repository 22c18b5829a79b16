/// The exceptions of the library: an input that breaks a rule, an output that cannot be written.
#pragma once

#include <cctype>
#include <stdexcept>
#include <string>

namespace haptic_cloth {

/// Bad configuration or file. The message is one line that names file, key, value and rule.
class InputError : public std::runtime_error {
 public:
  /// @param file  where the value stands ("scene.yaml", "--set", "~ (parameters)")
  /// @param key   dotted path of the key ("cloth.particles[0]"), empty for the file itself
  /// @param value the offending value as written, empty if there is none
  /// @param rule  what would be right ("must be > 0")
  InputError(const std::string& file, const std::string& key, const std::string& value,
             const std::string& rule)
      : std::runtime_error(oneLine(file) + (key.empty() ? "" : ": " + oneLine(key)) +
                           (value.empty() ? "" : " = " + oneLine(value)) + ": " + oneLine(rule)) {}

 private:
  static constexpr std::size_t kLongest = 2000;  ///< of each part [characters]

  /// Names and values come from files that may hold anything.
  static std::string oneLine(std::string text) {
    if (text.size() > kLongest) text = text.substr(0, kLongest) + "...";
    for (char& c : text) {
      if (std::iscntrl(static_cast<unsigned char>(c)) != 0) c = ' ';
    }
    return text;
  }
};

/// Output that cannot be written, for instance because the disk is full. The message names the file
/// and the reason.
class OutputError : public std::runtime_error {
 public:
  OutputError(const std::string& file, const std::string& reason)
      : std::runtime_error(file + ": cannot be written" + (reason.empty() ? "" : ": " + reason)) {}
};

}  // namespace haptic_cloth
