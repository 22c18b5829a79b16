#include "ros/input/vector_field.h"

#include <cctype>
#include <cstdint>
#include <cstring>

#include "haptic_cloth/error.h"

namespace haptic_cloth {
namespace {

std::string child(const std::string& path, const std::string& name) {
  return path.empty() ? name : path + "." + name;
}

std::string element(const std::string& path, std::size_t index) {
  return path + "[" + std::to_string(index) + "]";
}

/// Member at a dotted path; nullptr if there is none or if it lies in an array.
const MessageField* findField(const MessageLayout& layout, const std::string& path) {
  std::string type = layout.datatype();
  const MessageField* found = nullptr;
  for (std::size_t begin = 0; begin <= path.size();) {
    const std::size_t end = std::min(path.find('.', begin), path.size());
    if (found) {
      if (found->count != MessageField::kSingle || isNumber(found->type) || found->type == "string")
        return nullptr;
      type = found->type;
    }
    const MessageField* next = nullptr;
    for (const MessageField& field : layout.fields(type)) {
      if (field.name == path.substr(begin, end - begin)) next = &field;
    }
    if (!next) return nullptr;
    found = next;
    begin = end + 1;
  }
  return found;
}

/// Paths of the three numbers of the vector at `path`; empty if there is no vector.
std::vector<std::string> componentPaths(const MessageLayout& layout, const std::string& path) {
  std::string type = layout.datatype();
  if (!path.empty()) {
    const MessageField* field = findField(layout, path);
    if (!field) return {};
    if (isNumber(field->type)) {
      const bool long_enough = field->count >= 3 || field->count == MessageField::kVariable;
      if (!long_enough) return {};
      return {element(path, 0), element(path, 1), element(path, 2)};
    }
    if (field->count != MessageField::kSingle || field->type == "string" || builtinSize(field->type) > 0)
      return {};
    type = field->type;
  }
  std::vector<std::string> paths(3);
  for (const MessageField& field : layout.fields(type)) {
    if (field.name.size() != 1 || field.count != MessageField::kSingle || !isNumber(field.type)) continue;
    const int component = std::tolower(static_cast<unsigned char>(field.name[0])) - 'x';
    if (component >= 0 && component < 3) paths[static_cast<std::size_t>(component)] = child(path, field.name);
  }
  for (const std::string& each : paths) {
    if (each.empty()) return {};
  }
  return paths;
}

std::map<std::string, int> wantedNumbers(const MessageLayout& layout, const std::string& path) {
  std::map<std::string, int> wanted;
  for (const std::string& component : componentPaths(layout, path)) wanted.emplace(component, wanted.size());
  if (wanted.size() == 3) return wanted;
  throw InputError("definition of " + layout.datatype(), path, "",
                   "must be a member with x, y and z or an array of three numbers");
}

/// Walks through the bytes of a message and picks the wanted numbers.
class Walk {
 public:
  Walk(const MessageLayout& layout, const std::map<std::string, int>& wanted,
       const std::vector<unsigned char>& bytes)
      : layout_(layout), wanted_(wanted), bytes_(bytes) {}

  /// @return whether all three numbers were found
  bool run() {
    good_ = true;
    message(layout_.datatype(), "");
    return good_ && found_ == 3;
  }
  const Vec3& value() const { return value_; }

 private:
  bool done() const { return !good_ || found_ == 3; }

  bool has(std::size_t size) {
    good_ = good_ && bytes_.size() - at_ >= size;
    return good_;
  }

  std::uint32_t length() {
    std::uint32_t length = 0;
    if (!has(sizeof length)) return 0;
    std::memcpy(&length, bytes_.data() + at_, sizeof length);
    at_ += sizeof length;
    return length;
  }

  void message(const std::string& type, const std::string& path) {
    for (const MessageField& field : layout_.fields(type)) {
      if (done()) return;
      const std::string here = child(path, field.name);
      if (field.count == MessageField::kSingle) {
        single(field.type, here);
        continue;
      }
      const std::size_t count =
          field.count == MessageField::kVariable ? length() : static_cast<std::size_t>(field.count);
      for (std::size_t k = 0; k < count && !done(); ++k) single(field.type, element(here, k));
    }
  }

  void single(const std::string& type, const std::string& path) {
    if (type == "string") {
      const std::uint32_t size = length();
      if (has(size)) at_ += size;
      return;
    }
    const std::size_t size = builtinSize(type);
    if (size == 0) {
      message(type, path);
      return;
    }
    if (!has(size)) return;
    const auto component = wanted_.find(path);
    if (component != wanted_.end()) {
      value_[component->second] = readNumber(type, bytes_.data() + at_);
      ++found_;
    }
    at_ += size;
  }

  const MessageLayout& layout_;
  const std::map<std::string, int>& wanted_;
  const std::vector<unsigned char>& bytes_;
  std::size_t at_ = 0;
  bool good_ = true;
  int found_ = 0;
  Vec3 value_ = Vec3::Zero();
};

void appendWord(std::vector<unsigned char>& bytes, std::uint32_t word) {
  bytes.resize(bytes.size() + sizeof word);
  std::memcpy(bytes.data() + bytes.size() - sizeof word, &word, sizeof word);
}

}  // namespace

std::optional<std::string> findVector(const MessageLayout& layout,
                                      const std::vector<std::string>& candidates) {
  for (const std::string& path : candidates) {
    if (!componentPaths(layout, path).empty()) return path;
  }
  return std::nullopt;
}

const std::vector<std::string>& positionPaths() {
  static const std::vector<std::string> kPaths = {
      "pose.position", "pose.pose.position",    "position", "vector", "point", "linear", "twist.linear",
      "translation",   "transform.translation", ""};
  return kPaths;
}

const std::vector<std::string>& forcePaths() {
  static const std::vector<std::string> kPaths = {"wrench.force", "force", "vector", "linear", ""};
  return kPaths;
}

VectorReader::VectorReader(const MessageLayout& layout, const std::string& path)
    : layout_(layout), wanted_(wantedNumbers(layout, path)) {}

std::optional<Vec3> VectorReader::read(const std::vector<unsigned char>& bytes) const {
  Walk walk(layout_, wanted_, bytes);
  if (!walk.run()) return std::nullopt;
  return walk.value();
}

MessageHeader VectorReader::header(const std::vector<unsigned char>& bytes) const {
  constexpr std::size_t kFixed = 16;  // sequence number, seconds, nanoseconds, length of frame_id
  MessageHeader header;
  if (!layout_.hasHeader() || bytes.size() < kFixed) return header;
  std::uint32_t words[4];
  std::memcpy(words, bytes.data(), kFixed);
  header.stamp = ros::Time(words[1], words[2]);
  if (bytes.size() - kFixed >= words[3]) {
    header.frame_id.assign(reinterpret_cast<const char*>(bytes.data()) + kFixed, words[3]);
  }
  return header;
}

VectorWriter::VectorWriter(const MessageLayout& layout, const std::string& path,
                           const std::map<std::string, int>& lengths)
    : has_header_(layout.hasHeader()), wanted_(wantedNumbers(layout, path)) {
  std::map<std::string, int> all = lengths;
  all.emplace(path, 3);  // if the vector itself is a variable array
  append(layout.datatype(), "", all, layout);
}

void VectorWriter::append(const std::string& type, const std::string& path,
                          const std::map<std::string, int>& lengths, const MessageLayout& layout) {
  bool header = has_header_ && path.empty();
  for (const MessageField& field : layout.fields(type)) {
    if (!header) appendElements(field, child(path, field.name), lengths, layout);
    header = false;
  }
}

void VectorWriter::appendElements(const MessageField& field, const std::string& path,
                                  const std::map<std::string, int>& lengths, const MessageLayout& layout) {
  const bool single = field.count == MessageField::kSingle;
  int count = single ? 1 : field.count;
  if (field.count == MessageField::kVariable) {
    const auto length = lengths.find(path);
    count = length == lengths.end() ? 0 : length->second;
    appendWord(zero_, static_cast<std::uint32_t>(count));
  }
  for (int k = 0; k < count; ++k) {
    const std::string here = single ? path : element(path, static_cast<std::size_t>(k));
    if (field.type == "string") {
      appendWord(zero_, 0);
    } else if (const std::size_t size = builtinSize(field.type)) {
      const auto component = wanted_.find(here);
      if (component != wanted_.end()) targets_[component->second] = {field.type, zero_.size()};
      zero_.resize(zero_.size() + size);
    } else {
      append(field.type, here, lengths, layout);
    }
  }
}

std::vector<unsigned char> VectorWriter::write(const Vec3& value, const MessageHeader& header) const {
  std::vector<unsigned char> bytes;
  if (has_header_) {
    appendWord(bytes, 0);  // the sequence number
    appendWord(bytes, header.stamp.sec);
    appendWord(bytes, header.stamp.nsec);
    appendWord(bytes, static_cast<std::uint32_t>(header.frame_id.size()));
  }
  const std::size_t name = bytes.size(), body = name + (has_header_ ? header.frame_id.size() : 0);
  bytes.resize(body + zero_.size());
  if (has_header_) std::memcpy(bytes.data() + name, header.frame_id.data(), header.frame_id.size());
  std::memcpy(bytes.data() + body, zero_.data(), zero_.size());
  for (int k = 0; k < 3; ++k)
    writeNumber(targets_[k].type, value[k], bytes.data() + body + targets_[k].offset);
  return bytes;
}

}  // namespace haptic_cloth
