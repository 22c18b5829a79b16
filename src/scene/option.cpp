#include "scene/option.h"

#include <algorithm>
#include <cmath>
#include <sstream>

#include "fabric/yaml_reader.h"
#include "haptic_cloth/error.h"
#include "state/number_text.h"

namespace haptic_cloth {
namespace {

constexpr double kUnitTolerance = 1e-6;  ///< error allowed in a quaternion's norm [-]

/// Number without what an exponent does not need: 1e6 for 1e+06.
std::string plainText(double value) {
  std::string text = shortestText(value);
  const std::size_t e = text.find('e');
  if (e == std::string::npos) return text;
  if (text[e + 1] == '+') text.erase(e + 1, 1);
  const std::size_t digits = e + (text[e + 1] == '-' ? 2 : 1);
  while (text[digits] == '0') text.erase(digits, 1);
  return text;
}

/// Whether a rule has two ends. The general limits of lengths and numbers do not count.
bool hasTwoEnds(const Range& range) { return !range.above && range.most < kMostLength; }

/// @return the rule that the value breaks; empty if there is none
std::string brokenRule(const Range& range, double value) {
  const bool low = !(range.above ? value > range.least : value >= range.least), high = value > range.most;
  if (hasTwoEnds(range) && (low || high)) {
    return "must be in " + plainText(range.least) + " to " + plainText(range.most);
  }
  const bool bounded = std::isfinite(range.most);
  if (low || (!bounded && std::isinf(value))) {
    return (bounded ? "must be " : "must be finite and ") + std::string(range.above ? "> " : ">= ") +
           plainText(range.least);
  }
  if (bounded && range.above && (value < kSmallest || value > kLargest)) {
    return "must be within " + plainText(kSmallest) + " to " + plainText(kLargest);
  }
  return high ? "must be at most " + plainText(range.most) : "";
}

/// @return the rule that the value breaks; empty if there is none
std::string brokenRule(const Range& range, int value) {
  if (hasTwoEnds(range)) return brokenRule(range, static_cast<double>(value));
  return value >= range.least ? "" : "must be >= " + plainText(range.least);
}

std::string textOf(double value) { return shortestText(value); }
std::string textOf(int value) { return std::to_string(value); }

/// Numbers in brackets, separated by commas.
template <class Number>
std::string listText(const Number* first, std::size_t count) {
  std::string text;
  for (std::size_t k = 0; k < count; ++k) text += (k > 0 ? ", " : "") + plainText(first[k]);
  return '[' + text + ']';
}

/// Checks one row.
struct Checker {
  const Option& option;
  const std::string& key;
  const Locate& locate;

  template <class Number>
  void operator()(const Numbers<Number>& numbers) const {
    for (std::size_t k = 0; k < numbers.count; ++k) {
      const Number value = numbers.first[k];
      const std::string rule = brokenRule(option.range, value);
      if (!rule.empty()) fail(numbers.count > 1 ? indexed(key, k) : key, textOf(value), rule);
    }
  }
  void operator()(Quat* value) const {
    if (std::abs(value->norm() - 1.0) <= kUnitTolerance) return;
    std::ostringstream text;
    text << value->coeffs().transpose();
    fail(key, text.str(), "must be a unit quaternion x y z w");
  }
  void operator()(const Choice& choice) const {
    if (choice.get() >= choice.names.size()) fail(key, "no choice", oneOf(choice.names));
  }
  template <class Other>
  void operator()(const Other&) const {}  // any value of these types is allowed

  [[noreturn]] void fail(const std::string& name, const std::string& value, const std::string& rule) const {
    throw InputError(locate(name), name, value, rule);
  }
};

struct ValueText {
  template <class Number>
  std::string operator()(const Numbers<Number>& numbers) const {
    return numbers.count > 1 ? listText(numbers.first, numbers.count) : plainText(*numbers.first);
  }
  std::string operator()(const Quat* value) const { return listText(value->coeffs().data(), 4); }
  std::string operator()(const bool* value) const { return *value ? "true" : "false"; }
  std::string operator()(const std::string* value) const { return value->empty() ? "\"\"" : *value; }
  std::string operator()(const Choice& choice) const { return choice.names[choice.get()]; }
  std::string operator()(const OwnReader& own) const { return own.initial; }
};

std::string rangeText(const Range& range) {
  if (hasTwoEnds(range)) return plainText(range.least) + " to " + plainText(range.most);
  if (range.least <= -kMostLength) return "";
  const std::string most = range.most < kMostLength ? ", ≤ " + plainText(range.most) : "";
  return (range.above ? "> " : "≥ ") + plainText(range.least) + most;
}

/// Rule of one row in the reference.
struct RuleText {
  const Range& range;

  std::string operator()(const Numbers<double>& numbers) const {
    const std::string rule = rangeText(range);
    if (numbers.count == 1) return rule;
    return std::to_string(numbers.count) + " numbers" + (rule.empty() ? "" : " " + rule);
  }
  std::string operator()(const Numbers<int>& numbers) const {
    const std::string rule = rangeText(range);
    return (numbers.count == 1 ? "integer " : std::to_string(numbers.count) + " integers ") + rule;
  }
  std::string operator()(const Quat*) const { return "x, y, z, w of norm 1"; }
  std::string operator()(const bool*) const { return "`true`, `false`"; }
  std::string operator()(const std::string*) const { return "text"; }
  std::string operator()(const Choice& choice) const {
    std::string names;
    for (const std::string& name : choice.names) names += (names.empty() ? "`" : ", `") + name + '`';
    return names;
  }
  std::string operator()(const OwnReader& own) const { return own.rule; }
};

}  // namespace

std::string indexed(const std::string& key, std::size_t index) {
  return key + '[' + std::to_string(index) + ']';
}

std::vector<std::string> keysOf(const Options& options) {
  std::vector<std::string> keys;
  for (const Option& option : options) keys.push_back(option.key);
  return keys;
}

std::string oneOf(const std::vector<std::string>& names) { return "must be one of " + joined(names); }

void checkOptions(const Options& options, const std::string& prefix, const Locate& locate) {
  for (const Option& option : options) {
    std::visit(Checker{option, prefix + option.key, locate}, option.field);
  }
}

std::string describe(const Option& option) {
  std::string text = option.meaning;
  text.erase(std::remove(text.begin(), text.end(), '`'), text.end());
  if (const Choice* choice = std::get_if<Choice>(&option.field)) text += ": " + joined(choice->names);
  return option.unit.empty() ? text : text + " [" + option.unit + ']';
}

std::string valueText(const Option& option) { return std::visit(ValueText(), option.field); }

std::string markdownTable(const OptionGroup& group) {
  std::string text =
      "| key | default | unit | rule | live | meaning |\n| --- | --- | --- | --- | --- | --- |\n";
  for (const Option& option : group.options) {
    const std::string value = valueText(option);
    for (const std::string& cell :
         {'`' + group.path + option.key + '`', value.empty() ? "" : '`' + value + '`', option.unit,
          std::visit(RuleText{option.range}, option.field), std::string(option.live ? "yes" : ""),
          option.meaning}) {
      text += (cell.empty() ? "| " : "| " + cell + ' ');
    }
    text += "|\n";
  }
  return text;
}

}  // namespace haptic_cloth
