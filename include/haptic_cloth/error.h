/// Exceptions of the library: an input that breaks a rule, an output that cannot be written.
#pragma once

#include <cctype>
#include <stdexcept>
#include <string>

namespace haptic_cloth {

/// Bad configuration or file. The message is one line that names file, key, value and rule.
class InputError : public std::runtime_error {
 public:
  /// @param file  source of the value ("scene.yaml", "--set", "~ (parameters)")
  /// @param key   dotted path of the key ("cloth.particles[0]"), empty for the file itself
  /// @param value offending value as written, empty if there is none
  /// @param rule  rule that it breaks ("must be > 0")
  InputError(const std::string& file, const std::string& key, const std::string& value,
             const std::string& rule)
      : std::runtime_error(oneLine(file) + (key.empty() ? "" : ": " + oneLine(key)) +
                           (value.empty() ? "" : " = " + oneLine(value)) + ": " + oneLine(rule)) {}

 private:
  static constexpr std::size_t kLongest = 2000;  ///< largest length of each part [characters]

  /// Shortens the text and replaces control characters: names and values come from arbitrary files.
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
