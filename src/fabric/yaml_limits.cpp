#include "fabric/yaml_limits.h"

#include <yaml-cpp/eventhandler.h>
#include <yaml-cpp/yaml.h>

#include <sstream>

#include "haptic_cloth/error.h"

namespace haptic_cloth {
namespace {

/// Counts values and depth during parsing.
class Counter : public YAML::EventHandler {
 public:
  Counter(const std::string& origin, bool has_lines) : origin_(origin), has_lines_(has_lines) {}

  /// The parser finds endless empty documents in some malformed texts, such as one with a leading
  /// comma.
  void OnDocumentStart(const YAML::Mark&) override {
    if (begun_) throw InputError(origin_, "", "", "must hold one YAML document, not several");
    begun_ = true;
  }
  void OnDocumentEnd() override {}

  void OnNull(const YAML::Mark& mark, YAML::anchor_t) override { count(mark); }
  void OnScalar(const YAML::Mark& mark, const std::string&, YAML::anchor_t, const std::string&) override {
    count(mark);
  }
  void OnAlias(const YAML::Mark& mark, YAML::anchor_t) override {
    fail(mark, "must not hold an alias (*name); write the value again");
  }

  void OnSequenceStart(const YAML::Mark& mark, const std::string&, YAML::anchor_t,
                       YAML::EmitterStyle::value) override {
    open(mark);
  }
  void OnMapStart(const YAML::Mark& mark, const std::string&, YAML::anchor_t,
                  YAML::EmitterStyle::value) override {
    open(mark);
  }
  void OnSequenceEnd() override { --depth_; }
  void OnMapEnd() override { --depth_; }

 private:
  void count(const YAML::Mark& mark) {
    if (++values_ > YamlLimits::kValues) {
      fail(mark, "must hold at most " + std::to_string(YamlLimits::kValues) + " values");
    }
  }

  void open(const YAML::Mark& mark) {
    if (++depth_ > YamlLimits::kDepth) {
      fail(mark, "must not nest lists and mappings deeper than " + std::to_string(YamlLimits::kDepth));
    }
    count(mark);
  }

  [[noreturn]] void fail(const YAML::Mark& mark, const std::string& rule) const {
    const bool line_known = has_lines_ && !mark.is_null();
    throw InputError(origin_ + (line_known ? ':' + std::to_string(mark.line + 1) : ""), "", "", rule);
  }

  const std::string& origin_;
  bool has_lines_;
  bool begun_ = false;  ///< a document has begun
  std::size_t values_ = 0;
  int depth_ = 0;
};

}  // namespace

void checkYamlLimits(const std::string& text, const std::string& origin, bool has_lines) {
  if (text.size() > YamlLimits::kBytes) {
    throw InputError(origin, "", "", "must be at most " + std::to_string(YamlLimits::kBytes) + " bytes long");
  }
  std::istringstream stream(text);
  YAML::Parser parser(stream);
  Counter counter(origin, has_lines);
  while (parser.HandleNextDocument(counter)) {
  }
}

}  // namespace haptic_cloth
