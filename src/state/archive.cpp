#include "state/archive.h"

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <cstring>

#include "haptic_cloth/error.h"
#include "haptic_cloth/state_file.h"
#include "state/byte_hash.h"
#include "state/number_text.h"

namespace haptic_cloth {
namespace {

constexpr std::uint32_t kByteOrder = 0x01020304;
constexpr std::uint32_t kVersion = 17;  // version of the envelope and of the entries
constexpr std::size_t kMostInText = 8;  ///< numbers of an entry that messages show

/// Header between kStateMagic and the entries.
struct Envelope {
  std::uint32_t byte_order, version;
  std::uint64_t size, checksum;  ///< of the entries
};
static_assert(sizeof(Envelope) == 24, "no padding: files are read on other machines");

/// Computes FNV-1a, 64 bit, which detects every change of one byte.
std::uint64_t checksum(const std::string& bytes) {
  ByteHash hash;
  hash.add(bytes.data(), bytes.size());
  return hash.value();
}

template <class T>
void append(std::string& bytes, const T& value) {
  bytes.append(reinterpret_cast<const char*>(&value), sizeof(T));
}

template <class T>
T valueAt(const char* bytes) {
  T value;
  std::memcpy(&value, bytes, sizeof(value));
  return value;
}

double largestOf(const std::vector<double>& values) {
  double largest = 0.0;
  for (const double value : values) largest = std::max(largest, std::abs(value));
  return largest;
}

/// Multiples of about 1e-11 of the largest value: those of machines that round differently become the same,
/// with hardly an exception.
std::vector<double> rounded(std::vector<double> values) {
  constexpr int kBits = 36;
  const double largest = largestOf(values);
  if (!(largest > 0.0) || !std::isfinite(largest)) return values;
  const double unit = std::ldexp(1.0, std::ilogb(largest) - kBits);
  for (double& value : values) value = std::round(value / unit) * unit;
  return values;
}

}  // namespace

std::size_t Archive::headerSize() { return sizeof(kStateMagic) - 1 + sizeof(Envelope); }

void Archive::checkHeader(const std::string& start, std::uint64_t size, const std::string& origin) {
  const auto refuse = [&](const std::string& rule) { throw InputError(origin, "", "", rule); };
  const std::string magic = kStateMagic;
  if (start.compare(0, magic.size(), magic) != 0)
    refuse("must be a state that was saved: it does not begin as one");
  if (start.size() < headerSize()) refuse("is cut off");
  Envelope envelope{};
  std::memcpy(&envelope, start.data() + magic.size(), sizeof(envelope));
  if (envelope.byte_order != kByteOrder) refuse("comes from a machine with another byte order");
  if (envelope.version != kVersion) {
    throw InputError(origin, "version", std::to_string(envelope.version),
                     "must be " + std::to_string(kVersion) + ", the one this program writes");
  }
  const std::uint64_t held = size - headerSize();
  if (held != envelope.size) {
    refuse("has " + std::to_string(held) + " bytes of " + std::to_string(envelope.size) +
           ": it is cut off or has grown");
  }
}

Archive::Archive(const std::string& sealed, std::string origin) : loads_(true), origin_(std::move(origin)) {
  checkHeader(sealed.substr(0, headerSize()), sealed.size(), origin_);
  Envelope envelope{};
  std::memcpy(&envelope, sealed.data() + headerSize() - sizeof(envelope), sizeof(envelope));
  entries_ = sealed.substr(headerSize());
  if (checksum(entries_) != envelope.checksum) fail("", "", "is damaged: its checksum does not fit");
}

std::string Archive::sealed() const {
  std::string bytes = kStateMagic;
  append(bytes, Envelope{kByteOrder, kVersion, entries_.size(), checksum(entries_)});
  return bytes + entries_;
}

std::vector<std::pair<std::string, std::string>> Archive::texts() const {
  std::vector<std::pair<std::string, std::string>> texts;
  for (std::size_t at = 0; at < entries_.size();) {
    const std::string name = takeName(at, "");
    const Header header = takeHeader(at, "");
    const std::string bytes = entries_.substr(header.begin, header.count * sizeOf(header.type));
    const bool is_long = header.type != Type::Byte && header.count > kMostInText;
    texts.emplace_back(
        name, is_long ? hexadecimalText(checksum(bytes)) : text(header.type, bytes.data(), header.count));
  }
  return texts;
}

std::size_t Archive::sizeOf(Type type) {
  switch (type) {
    case Type::Byte:
      return 1;
    case Type::Int:
      return sizeof(int);
    case Type::Long:
      return sizeof(long);
    case Type::Double:
      break;
  }
  return sizeof(double);
}

void Archive::write(const std::string& name, Type type, const void* data, std::size_t count) {
  const std::string path = prefix_ + name;
  append(entries_, static_cast<std::uint32_t>(path.size()));
  entries_ += path;
  append(entries_, type);
  append(entries_, static_cast<std::uint64_t>(count));
  entries_.append(static_cast<const char*>(data), count * sizeOf(type));
}

/// Takes bytes of the entries from `at` on, which moves behind them.
const char* Archive::take(std::size_t& at, std::size_t size, const std::string& wanted) const {
  if (entries_.size() - at < size) fail(wanted, "", "is missing");
  at += size;
  return entries_.data() + at - size;
}

std::string Archive::takeName(std::size_t& at, const std::string& wanted) const {
  std::uint32_t length = 0;
  std::memcpy(&length, take(at, sizeof(length), wanted), sizeof(length));
  return {take(at, length, wanted), length};
}

/// Takes the rest of an entry. Lengths are compared so that nothing overflows.
Archive::Header Archive::takeHeader(std::size_t& at, const std::string& wanted) const {
  Header header{};
  std::memcpy(&header.type, take(at, sizeof(header.type), wanted), sizeof(header.type));
  std::uint64_t count = 0;
  std::memcpy(&count, take(at, sizeof(count), wanted), sizeof(count));
  if (count > entries_.size()) fail(wanted, "", "is cut off");
  header.count = count;
  header.begin = at;
  take(at, count * sizeOf(header.type), wanted);
  return header;
}

/// Reads the next entry, which must have this name.
Archive::Header Archive::read(const std::string& name) {
  const std::string found = takeName(at_, name);
  if (found != prefix_ + name) fail(name, "", "must follow here, where '" + found + "' does");
  return takeHeader(at_, name);
}

void Archive::entry(const std::string& name, Type type, void* data, std::size_t count) {
  if (!loads_) return write(name, type, data, count);
  const Header header = read(name);
  if (header.type != type) fail(name, "", "has another type than it should");
  if (header.count != count) {
    fail(name, "", "has " + std::to_string(header.count) + " values, not " + std::to_string(count));
  }
  if (count > 0) std::memcpy(data, entries_.data() + header.begin, count * sizeOf(type));
  if (type != Type::Double) return;
  const auto* first = static_cast<const double*>(data);
  check(std::all_of(first, first + count, [](double value) { return std::isfinite(value); }), name,
        "must be finite");
}

void Archive::compare(const std::string& name, Type type, const void* data, std::size_t count) {
  if (!loads_) return write(name, type, data, count);
  const Header header = read(name);
  const auto* here = static_cast<const char*>(data);
  const std::size_t size = count * sizeOf(type);
  if (header.type == type && header.count == count && entries_.compare(header.begin, size, here, size) == 0)
    return;
  differs(name, header, text(type, here, count));
}

void Archive::similar(const std::string& name, const std::vector<double>& values) {
  constexpr double kRounding = 1e-9;
  if (!loads_) {
    const std::vector<double> kept = rounded(values);
    return write(name, Type::Double, kept.data(), kept.size());
  }
  const Header header = read(name);
  std::vector<double> found(header.type == Type::Double ? header.count : 0);
  if (!found.empty())
    std::memcpy(found.data(), entries_.data() + header.begin, found.size() * sizeof(double));
  double difference = 0.0;
  for (std::size_t k = 0; k < values.size() && found.size() == values.size(); ++k)
    difference = std::max(difference, std::abs(values[k] - found[k]));
  if (found.size() == values.size() && difference <= kRounding * largestOf(values)) return;
  differs(name, header, "other values");
}

std::string Archive::text(Type type, const char* bytes, std::size_t count) const {
  if (type == Type::Byte) return count > 0 ? std::string(bytes, count) : "''";
  if (count > kMostInText) return std::to_string(count) + " values";
  std::string text;
  for (std::size_t k = 0; k < count; ++k) {
    const char* const at = bytes + k * sizeOf(type);
    if (k > 0) text += ", ";
    if (type == Type::Int) text += std::to_string(valueAt<int>(at));
    if (type == Type::Long) text += std::to_string(valueAt<long>(at));
    if (type == Type::Double) text += shortestText(valueAt<double>(at));
  }
  return count == 1 ? text : "[" + text + "]";
}

void Archive::differs(const std::string& name, const Header& found, const std::string& here) const {
  fail(name, text(found.type, entries_.data() + found.begin, found.count), "the scene here has " + here);
}

void Archive::fail(const std::string& name, const std::string& value, const std::string& rule) const {
  throw InputError(origin_, name.empty() ? "" : prefix_ + name, value, rule);
}

void Archive::finish() const { check(at_ == entries_.size(), "", "has more entries than it should"); }

}  // namespace haptic_cloth
