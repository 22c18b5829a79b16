/// The layout of a ROS message whose type is known only at run time, from the definition that comes with
/// every connection.
#pragma once

#include <map>
#include <string>
#include <vector>

namespace haptic_cloth {

/// One member of a message.
struct MessageField {
  std::string type;  ///< of one element: a built-in name, or package/Name
  std::string name;
  int count = kSingle;  ///< elements of a fixed array, or one of these
  static constexpr int kSingle = -1;
  static constexpr int kVariable = -2;
};

/// A message type and all types in it.
class MessageLayout {
 public:
  /// @param datatype package/Name
  /// @param definition as in a connection header: the message's text, then "===" lines, "MSG: package/Name"
  /// and text of each type in it
  /// @throws InputError where it cannot be understood
  MessageLayout(const std::string& datatype, const std::string& definition);

  const std::string& datatype() const { return datatype_; }

  /// Members of a type of this layout. @throws InputError if the definition does not hold it
  const std::vector<MessageField>& fields(const std::string& type) const;
  const std::vector<MessageField>& fields() const { return fields(datatype_); }

  /// Whether the message begins with a std_msgs/Header.
  bool hasHeader() const;

  /// The fingerprint that publishers and subscribers compare, as genmsg computes it.
  std::string fingerprint() const { return fingerprint(datatype_, 0); }

 private:
  struct Type {
    std::string constants;  ///< lines of the fingerprint's text
    std::vector<MessageField> fields;
  };
  void addType(const std::string& name, const std::string& text);
  std::string fingerprint(const std::string& type, int depth) const;

  std::string datatype_;
  std::map<std::string, Type> types_;
};

/// Bytes of a built-in type of fixed size; 0 for strings and messages.
std::size_t builtinSize(const std::string& type);

/// Whether a built-in type is a number, not text, time or duration.
bool isNumber(const std::string& type);

/// The number of a built-in type at `bytes`, which holds builtinSize(type) bytes.
double readNumber(const std::string& type, const unsigned char* bytes);

/// Writes it, for integers rounded and held within the type's range.
void writeNumber(const std::string& type, double value, unsigned char* bytes);

}  // namespace haptic_cloth
