/// Layout of a ROS message whose type is known only at run time. It is parsed from the definition
/// that every connection sends.
#pragma once

#include <map>
#include <string>
#include <vector>

namespace haptic_cloth {

/// One member of a message.
struct MessageField {
  std::string type;  ///< type of one element: a built-in name, or package/Name
  std::string name;
  int count = kSingle;  ///< length of a fixed array, or one of these constants
  static constexpr int kSingle = -1;
  static constexpr int kVariable = -2;
};

/// A message type and all types it contains.
class MessageLayout {
 public:
  /// @param datatype package/Name
  /// @param definition as in a connection header: the text of the message, then for each contained
  /// type a line "===", a line "MSG: package/Name" and its text
  /// @throws InputError if it cannot be parsed
  MessageLayout(const std::string& datatype, const std::string& definition);

  const std::string& datatype() const { return datatype_; }

  /// Members of a type in this layout. @throws InputError if the definition does not contain it
  const std::vector<MessageField>& fields(const std::string& type) const;
  const std::vector<MessageField>& fields() const { return fields(datatype_); }

  /// Whether the message begins with a std_msgs/Header.
  bool hasHeader() const;

  /// The MD5 sum that publishers and subscribers compare, computed as in genmsg.
  std::string fingerprint() const { return fingerprint(datatype_, 0); }

 private:
  struct Type {
    std::string constants;  ///< lines of constants in the text for the MD5 sum
    std::vector<MessageField> fields;
  };
  void addType(const std::string& name, const std::string& text);
  std::string fingerprint(const std::string& type, int depth) const;

  std::string datatype_;
  std::map<std::string, Type> types_;
};

/// Size of a built-in type in bytes; 0 for strings and messages.
std::size_t builtinSize(const std::string& type);

/// Whether a built-in type is a number: not text, time or duration.
bool isNumber(const std::string& type);

/// Reads a number of a built-in type from builtinSize(type) bytes.
double readNumber(const std::string& type, const unsigned char* bytes);

/// Writes a number. For an integer type it is rounded and clamped to the type's range.
void writeNumber(const std::string& type, double value, unsigned char* bytes);

}  // namespace haptic_cloth
