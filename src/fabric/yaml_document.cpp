#include <algorithm>
#include <array>
#include <cctype>
#include <cerrno>
#include <cstring>
#include <filesystem>
#include <fstream>
#include <sstream>

#include "fabric/yaml_limits.h"
#include "fabric/yaml_reader.h"

namespace haptic_cloth {
namespace {

/// Hint at the usual faults where a parser fails: a tab, or no space behind the colon of a key. The parser
/// may notice the latter a line late. Empty if there is neither.  @param line counted from 0
std::string likelyFault(const std::string& text, int line) {
  std::istringstream lines(text);
  std::string now, before;
  for (int k = 0; k <= line && (before = now, std::getline(lines, now)); ++k) {
  }
  const auto lacksSpace = [](const std::string& in) {
    const std::size_t start = in.find_first_not_of(" -"), colon = in.find(':');
    return start < colon && colon + 1 < in.size() &&
           std::isalpha(static_cast<unsigned char>(in[start])) != 0 &&
           std::isspace(static_cast<unsigned char>(in[colon + 1])) == 0;
  };
  if (now.find('\t') != std::string::npos) return " (the line has a tab: indent with spaces)";
  if (lacksSpace(before)) return " (the line before lacks a space behind the colon)";
  if (lacksSpace(now)) return " (the line lacks a space behind the colon)";
  return "";
}

/// Parses the only YAML document in `text`.
YAML::Node parseText(const std::string& text, const std::string& origin, bool has_lines) {
  try {
    checkYamlLimits(text, origin, has_lines);
    const std::vector<YAML::Node> documents = YAML::LoadAll(text);
    if (documents.size() > 1) throw InputError(origin, "", "", "must hold one YAML document, not several");
    return documents.empty() ? YAML::Node() : documents.front();
  } catch (const YAML::Exception& error) {
    const bool line_known = has_lines && !error.mark.is_null();
    throw InputError(origin + (line_known ? ':' + std::to_string(error.mark.line + 1) : ""), "", "",
                     "malformed YAML: " + error.msg + (line_known ? likelyFault(text, error.mark.line) : ""));
  }
}

std::string readFile(const std::string& file) {
  std::error_code ignored;
  if (std::filesystem::is_directory(file, ignored)) {
    throw InputError(file, "", "", "is a directory, must be a YAML file");
  }
  std::ifstream stream(file, std::ios::binary);
  // Reading stops after the first part beyond the limit, if a file is too long or endless like a
  // device.
  std::string text;
  for (std::array<char, 1 << 14> part{}; stream && text.size() <= YamlLimits::kBytes;) {
    stream.read(part.data(), part.size());
    text.append(part.data(), static_cast<std::size_t>(stream.gcount()));
  }
  if (!stream.is_open() || stream.bad())
    throw InputError(file, "", "", "cannot be read: " + std::string(std::strerror(errno)));
  return text;
}

std::optional<std::size_t> parseIndex(const std::string& part) {
  const bool digits =
      !part.empty() && part.size() < 9 &&
      std::all_of(part.begin(), part.end(), [](unsigned char c) { return std::isdigit(c) != 0; });
  if (!digits) return {};
  return std::stoul(part);
}

/// Parts of one assignment "a.b=VALUE".
struct Assignment {
  std::string by, text;
  std::vector<std::string> parts;
  YAML::Node value;

  [[noreturn]] void fail(const std::string& rule) const {
    throw InputError(by, describe(YAML::Node(text)), "", rule);
  }
};

Assignment parseAssignment(const std::string& text, const std::string& by) {
  Assignment assignment{by, text, {}, YAML::Node()};
  const std::size_t equals = text.find('=');
  if (equals == std::string::npos || equals == 0) assignment.fail("must be KEY=VALUE");
  assignment.parts = splitKey(text.substr(0, equals));
  for (const std::string& part : assignment.parts) {
    if (part.empty()) assignment.fail("must be KEY=VALUE with KEY such as cloth.size or obstacles.0.radius");
  }
  if (assignment.parts.size() > static_cast<std::size_t>(YamlLimits::kDepth)) {
    assignment.fail("must be KEY=VALUE with at most " + std::to_string(YamlLimits::kDepth) + " parts in KEY");
  }
  assignment.value = parseText(text.substr(equals + 1), by + ": " + describe(YAML::Node(text)), false);
  if (assignment.value.IsNull()) assignment.fail("must have a value behind the =");
  return assignment;
}

/// Copies `node` and replaces the part that assignment.parts[depth...] names. Nodes off that path
/// are shared. Appends the path to `key`, and sets `made` to the first part of it that was not there.
YAML::Node replaced(const YAML::Node& node, const Assignment& assignment, std::size_t depth, std::string& key,
                    std::string& made) {
  if (depth == assignment.parts.size()) return assignment.value;
  const std::string& part = assignment.parts[depth];

  if (node.IsSequence()) {
    const auto index = parseIndex(part);
    if (!index || *index >= node.size()) {
      assignment.fail(part + " must be an index below " + std::to_string(node.size()) + ", the length of " +
                      key);
    }
    key += '[' + std::to_string(*index) + ']';
    YAML::Node copy(YAML::NodeType::Sequence);
    for (std::size_t i = 0; i < node.size(); ++i) {
      copy.push_back(i == *index ? replaced(node[i], assignment, depth + 1, key, made) : YAML::Node(node[i]));
    }
    return copy;
  }

  if (node.IsNull() && parseIndex(part)) assignment.fail(key + " must be a list that has an element " + part);
  if (node.IsScalar()) assignment.fail(key + " = " + describe(node) + " has no keys below it");
  key += (key.empty() ? "" : ".") + part;
  YAML::Node copy(YAML::NodeType::Map);
  bool found = false;
  for (const auto& entry : node) {
    const bool here = !found && entry.first.IsScalar() && entry.first.Scalar() == part;
    found = found || here;
    copy.force_insert(entry.first,
                      here ? replaced(entry.second, assignment, depth + 1, key, made) : entry.second);
  }
  if (!found) {
    if (made.empty()) made = key;
    copy.force_insert(part, replaced(YAML::Node(), assignment, depth + 1, key, made));
  }
  return copy;
}

}  // namespace

std::vector<std::string> splitKey(const std::string& key) {
  std::vector<std::string> parts(1);
  for (std::size_t i = 0; i < key.size(); ++i) {
    const bool bracket = key[i] == '[';
    if (key[i] == '.' || bracket) {
      parts.emplace_back();
    } else if (key[i] != ']') {
      parts.back() += key[i];
    }
  }
  return parts;
}

YamlDocument::YamlDocument(const std::string& text, const std::string& origin, bool has_lines)
    : root_(parseText(text, origin, has_lines)), source_{origin, has_lines, {}, ""} {
  if (!root_.IsDefined() || root_.IsNull())
    throw InputError(origin, "", "", "is empty, must be a YAML mapping");
  if (!root_.IsMap()) throw InputError(origin, describe(root_), "", "must be a YAML mapping");
}

YamlDocument YamlDocument::fromFile(const std::string& file) {
  return YamlDocument(readFile(file), file, true);
}

YamlDocument YamlDocument::fromText(const std::string& text, const std::string& origin) {
  return YamlDocument(text, origin, false);
}

void YamlDocument::override(const std::string& assignment, const std::string& by) {
  std::string key, made;
  root_.reset(replaced(root_, parseAssignment(assignment, by), 0, key, made));
  source_.overridden.push_back(made.empty() ? key : made);
  source_.overridden_by = by;
}

YamlValue YamlDocument::root() const {
  return YamlValue(root_, std::make_shared<const YamlSource>(source_), "");
}

std::string YamlDocument::locate(const std::string& key) const {
  YAML::Node node = root_;
  for (const std::string& part : splitKey(key)) {
    YAML::Node next(YAML::NodeType::Undefined);
    const auto index = parseIndex(part);
    if (node.IsSequence() && index && *index < node.size()) next.reset(node[*index]);
    if (node.IsMap()) {
      for (const auto& entry : node) {
        if (entry.first.IsScalar() && entry.first.Scalar() == part) next.reset(entry.second);
      }
    }
    if (!next.IsDefined()) break;
    node.reset(next);
  }
  return source_.at(key, node.Mark().line);
}

}  // namespace haptic_cloth
