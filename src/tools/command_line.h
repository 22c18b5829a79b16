/// Command line of a program: options, and one file that needs no option.
#pragma once

#include <boost/program_options.hpp>
#include <string>
#include <type_traits>
#include <utility>
#include <vector>

namespace haptic_cloth {

/// A command line that cannot be used; the message names the argument.
using UsageError = boost::program_options::error;

class CommandLine {
 public:
  /// @param description what the program does, printed above its options
  /// @param file_name name of the one argument without an option, for help and messages
  /// @param file receives that argument; must outlive this object
  /// @param file_help explains that argument
  CommandLine(std::string program, std::string description, std::string file_name, std::string& file,
              std::string file_help);

  /// Adds an option that takes a value, `--name VALUE` or `--name=VALUE`. A std::vector collects one value
  /// of each time that the option is given; any other type takes one. A std::string takes a name, which is
  /// not empty: a script whose variable is not set would get a run without that file.
  template <class Value>
  void add(const char* name, Value& value, const char* value_name, const char* help) {
    auto* const semantic = boost::program_options::value(&value)->value_name(value_name);
    if constexpr (std::is_same_v<Value, std::string>) {
      semantic->notifier([name](const std::string& text) { requireName("--" + std::string(name), text); });
    }
    options_.add_options()(name, semantic, help);
  }

  /// Adds an option without a value.
  void addFlag(const char* name, bool& flag, const char* help) {
    options_.add_options()(name, boost::program_options::bool_switch(&flag), help);
  }

  /// Adds an option that prints a page instead of running.
  void addPage(const char* name, std::string text, const char* help) {
    options_.add_options()(name, help);
    pages_.emplace_back(name, std::move(text));
  }

  /// Prints this below the options.
  void setFooter(std::string footer) { footer_ = std::move(footer); }

  /// Reads the arguments. An option's name must be spelled out.
  /// @return false: help or a page was asked for and is printed, nothing was read
  /// @throws UsageError
  bool read(int argc, const char* const* argv);

 private:
  /// @throws UsageError if the text is empty
  static void requireName(const std::string& argument, const std::string& text);
  std::string help() const;

  std::string program_, description_, footer_, file_name_, file_help_;
  std::vector<std::pair<std::string, std::string>> pages_;  ///< by the name of their option
  std::string& file_;
  boost::program_options::options_description options_;
};

/// Checks that a word is one of those that a table names.
/// @throws UsageError that lists them
template <class Table>
void requireOneOf(const Table& table, const std::string& option, const std::string& word) {
  if (table.count(word) > 0) return;
  std::string known;
  for (const auto& entry : table) known += (known.empty() ? "" : ", ") + entry.first;
  throw UsageError(option + ": " + word + ": must be one of " + known);
}

}  // namespace haptic_cloth
