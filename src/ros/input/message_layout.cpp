#include "ros/input/message_layout.h"

#include <cmath>
#include <cstdint>
#include <cstring>
#include <limits>
#include <sstream>

#include "haptic_cloth/error.h"
#include "ros/input/md5.h"

namespace haptic_cloth {
namespace {

constexpr char kHeader[] = "std_msgs/Header";
constexpr int kDeepest = 32;  ///< nesting of messages

std::string trimmed(const std::string& text) {
  const char* spaces = " \t\r\n";
  const std::size_t first = text.find_first_not_of(spaces);
  return first == std::string::npos ? "" : text.substr(first, text.find_last_not_of(spaces) - first + 1);
}

bool isBuiltin(const std::string& type) { return type == "string" || builtinSize(type) > 0; }

/// Full name of a type that a message of `package` uses.
std::string fullName(const std::string& type, const std::string& package) {
  if (isBuiltin(type) || type.find('/') != std::string::npos) return type;
  return type == "Header" ? kHeader : package + "/" + type;
}

/// Parses a type written as `type`, `type[]` or `type[3]`.
MessageField fieldOf(const std::string& written, const std::string& name, const std::string& package,
                     const std::string& origin) {
  MessageField field;
  field.name = name;
  const std::size_t bracket = written.find('[');
  field.type = fullName(written.substr(0, bracket), package);
  if (bracket == std::string::npos) return field;
  const std::string count = written.substr(bracket + 1, written.size() - bracket - 2);
  const bool digits = count.find_first_not_of("0123456789") == std::string::npos && count.size() < 9;
  if (written.back() != ']' || !digits) throw InputError(origin, name, written, "is no array of ROS");
  field.count = count.empty() ? MessageField::kVariable : std::stoi(count);
  return field;
}

template <class Number>
double read(const unsigned char* bytes) {
  Number number;
  std::memcpy(&number, bytes, sizeof number);
  return static_cast<double>(number);
}

template <class Number>
void write(double value, unsigned char* bytes) {
  if (std::numeric_limits<Number>::is_integer) {
    const auto low = static_cast<double>(std::numeric_limits<Number>::lowest());
    const auto high = static_cast<double>(std::numeric_limits<Number>::max());
    value = std::round(value);
    // At 64 bits the limits are not exact doubles. A value outside them becomes the limit itself.
    const Number held = value <= low    ? std::numeric_limits<Number>::lowest()
                        : value >= high ? std::numeric_limits<Number>::max()
                                        : static_cast<Number>(value);
    std::memcpy(bytes, &held, sizeof held);
  } else {
    const auto number = static_cast<Number>(value);
    std::memcpy(bytes, &number, sizeof number);
  }
}

/// Size and access of a built-in number.
struct NumberType {
  std::size_t size;
  double (*read)(const unsigned char*);
  void (*write)(double, unsigned char*);
};

template <class Number>
NumberType numberType() {
  return {sizeof(Number), read<Number>, write<Number>};
}

/// @return nullptr if the type is not a number
const NumberType* findNumber(const std::string& type) {
  static const std::map<std::string, NumberType> kNumbers = {
      {"bool", numberType<std::uint8_t>()},    {"byte", numberType<std::int8_t>()},
      {"char", numberType<std::uint8_t>()},    {"int8", numberType<std::int8_t>()},
      {"uint8", numberType<std::uint8_t>()},   {"int16", numberType<std::int16_t>()},
      {"uint16", numberType<std::uint16_t>()}, {"int32", numberType<std::int32_t>()},
      {"uint32", numberType<std::uint32_t>()}, {"int64", numberType<std::int64_t>()},
      {"uint64", numberType<std::uint64_t>()}, {"float32", numberType<float>()},
      {"float64", numberType<double>()}};
  const auto entry = kNumbers.find(type);
  return entry == kNumbers.end() ? nullptr : &entry->second;
}

}  // namespace

MessageLayout::MessageLayout(const std::string& datatype, const std::string& definition)
    : datatype_(datatype) {
  std::istringstream lines(definition);
  std::string name = datatype, text;
  for (std::string line; std::getline(lines, line);) {
    if (line.rfind("===", 0) == 0) {
      addType(name, text);
      text.clear();
      name.clear();
    } else if (name.empty() && line.rfind("MSG:", 0) == 0) {
      name = trimmed(line.substr(4));
    } else {
      text += line + '\n';
    }
  }
  addType(name, text);
  fingerprint();  // throws if the definition of a contained type is missing
}

void MessageLayout::addType(const std::string& name, const std::string& text) {
  const std::string package = name.substr(0, name.find('/'));
  const std::string origin = "definition of " + name;
  if (name.find('/') == std::string::npos) throw InputError(origin, "type", name, "must be package/Name");
  Type type;
  std::istringstream lines(text);
  for (std::string line; std::getline(lines, line);) {
    const std::string content = trimmed(line.substr(0, line.find('#')));
    if (content.empty()) continue;
    const std::size_t space = content.find_first_of(" \t");
    if (space == std::string::npos) throw InputError(origin, "line", content, "must be a type and a name");
    const std::string written = content.substr(0, space);
    const std::string rest = trimmed(content.substr(space));
    const std::size_t equals = rest.find('=');
    if (equals == std::string::npos) {
      type.fields.push_back(fieldOf(written, rest, package, origin));
      continue;
    }
    // The value of a string constant extends to the end of the line, including any '#'.
    const std::string value = written == "string" ? line.substr(line.find('=') + 1) : rest.substr(equals + 1);
    type.constants += written + " " + trimmed(rest.substr(0, equals)) + "=" + trimmed(value) + "\n";
  }
  types_.emplace(name, type);
}

const std::vector<MessageField>& MessageLayout::fields(const std::string& type) const {
  const auto entry = types_.find(type);
  if (entry == types_.end()) throw InputError("definition of " + datatype_, "type", type, "is not in it");
  return entry->second.fields;
}

bool MessageLayout::hasHeader() const {
  const std::vector<MessageField>& members = fields();
  return !members.empty() && members[0].type == kHeader && members[0].count == MessageField::kSingle;
}

std::string MessageLayout::fingerprint(const std::string& type, int depth) const {
  if (depth > kDeepest) throw InputError("definition of " + datatype_, "type", type, "contains itself");
  std::string text;
  const std::vector<MessageField>& members = fields(type);
  for (const MessageField& field : members) {
    std::string word = field.type;
    if (!isBuiltin(field.type)) {
      word = fingerprint(field.type, depth + 1);
    } else if (field.count != MessageField::kSingle) {
      word += field.count == MessageField::kVariable ? "[]" : "[" + std::to_string(field.count) + "]";
    }
    text += word + " " + field.name + "\n";
  }
  return md5(trimmed(types_.at(type).constants + text));
}

std::size_t builtinSize(const std::string& type) {
  if (type == "time" || type == "duration") return 8;
  const NumberType* number = findNumber(type);
  return number ? number->size : 0;
}

bool isNumber(const std::string& type) { return findNumber(type) != nullptr; }

double readNumber(const std::string& type, const unsigned char* bytes) {
  return findNumber(type)->read(bytes);
}

void writeNumber(const std::string& type, double value, unsigned char* bytes) {
  findNumber(type)->write(value, bytes);
}

}  // namespace haptic_cloth
