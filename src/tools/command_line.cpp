#include "tools/command_line.h"

#include <iostream>
#include <sstream>
#include <utility>
#include <vector>

#include "tools/standard_output.h"

namespace haptic_cloth {

namespace po = boost::program_options;

namespace {

constexpr unsigned kColumns = 100;       ///< of the help's lines
constexpr const char* kFile = "<file>";  ///< no name that anyone types after two dashes

/// Dashes and equal signs as everywhere, but no abbreviated names: a later option must not change what a
/// script's command line means.
constexpr int kStyle = po::command_line_style::unix_style & ~po::command_line_style::allow_guessing;

/// @return false, as nothing is left to do
bool print(const std::string& text) {
  std::cout << text;
  requireStandardOutput();
  return false;
}

}  // namespace

CommandLine::CommandLine(std::string program, std::string description, std::string file_name,
                         std::string& file, std::string file_help)
    : program_(std::move(program)),
      description_(std::move(description)),
      file_name_(std::move(file_name)),
      file_help_(std::move(file_help)),
      file_(file),
      options_("Options", kColumns, kColumns / 2) {
  options_.add_options()("help,h", "prints this and exits");
}

bool CommandLine::read(int argc, const char* const* argv) {
  std::vector<std::string> files;
  po::options_description all;
  all.add(options_).add_options()(kFile, po::value(&files));
  po::positional_options_description positional;
  positional.add(kFile, -1);
  po::variables_map values;
  po::store(po::command_line_parser(argc, argv).options(all).positional(positional).style(kStyle).run(),
            values);
  if (values.count("help") > 0) return print(help());
  for (const auto& [name, text] : pages_) {
    if (values.count(name) > 0) return print(text);
  }
  po::notify(values);
  if (files.empty()) throw UsageError(file_name_ + " is required");
  if (files.size() > 1) throw UsageError("the following argument was not expected: " + files[1]);
  requireName(file_name_, files[0]);
  file_ = files[0];
  return true;
}

void CommandLine::requireName(const std::string& argument, const std::string& text) {
  if (text.empty()) throw UsageError(argument + ": must have a name");
}

std::string CommandLine::help() const {
  std::ostringstream text;
  text << description_ << "\nUsage: " << program_ << " [OPTIONS] " << file_name_ << "\n\n"
       << file_name_ << ": " << file_help_ << "\n\n"
       << options_;
  if (!footer_.empty()) text << '\n' << footer_ << '\n';
  return text.str();
}

}  // namespace haptic_cloth
