#include "fabric/yaml_limits.h"

#include <yaml-cpp/eventhandler.h>
#include <yaml-cpp/yaml.h>

#include <sstream>
#include <unordered_map>
#include <vector>

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

  void OnNull(const YAML::Mark& mark, YAML::anchor_t anchor) override { leaf(mark, anchor); }
  void OnScalar(const YAML::Mark& mark, const std::string&, YAML::anchor_t anchor,
                const std::string&) override {
    leaf(mark, anchor);
  }
  void OnAlias(const YAML::Mark& mark, YAML::anchor_t anchor) override {
    const auto size = sizes_.find(anchor);
    if (size == sizes_.end()) fail(mark, "must not hold an alias of what it stands in");
    add(mark, size->second);
  }

  void OnSequenceStart(const YAML::Mark& mark, const std::string&, YAML::anchor_t anchor,
                       YAML::EmitterStyle::value) override {
    open(mark, anchor);
  }
  void OnMapStart(const YAML::Mark& mark, const std::string&, YAML::anchor_t anchor,
                  YAML::EmitterStyle::value) override {
    open(mark, anchor);
  }
  void OnSequenceEnd() override { close(); }
  void OnMapEnd() override { close(); }

 private:
  /// List or mapping that is not complete yet.
  struct Open {
    YAML::anchor_t anchor;
    std::size_t values_before;
  };

  void add(const YAML::Mark& mark, std::size_t values) {
    values_ += values;
    if (values_ > YamlLimits::kValues) {
      fail(mark, "must hold at most " + std::to_string(YamlLimits::kValues) +
                     " values, those that aliases stand for counted each time");
    }
  }

  void leaf(const YAML::Mark& mark, YAML::anchor_t anchor) {
    add(mark, 1);
    if (anchor != YAML::NullAnchor) sizes_[anchor] = 1;
  }

  void open(const YAML::Mark& mark, YAML::anchor_t anchor) {
    open_.push_back({anchor, values_});
    if (open_.size() > static_cast<std::size_t>(YamlLimits::kDepth)) {
      fail(mark, "must not nest lists and mappings deeper than " + std::to_string(YamlLimits::kDepth));
    }
    add(mark, 1);
  }

  void close() {
    const Open ended = open_.back();
    open_.pop_back();
    if (ended.anchor != YAML::NullAnchor) sizes_[ended.anchor] = values_ - ended.values_before;
  }

  [[noreturn]] void fail(const YAML::Mark& mark, const std::string& rule) const {
    const bool line_known = has_lines_ && !mark.is_null();
    throw InputError(origin_ + (line_known ? ':' + std::to_string(mark.line + 1) : ""), "", "", rule);
  }

  const std::string& origin_;
  bool has_lines_;
  bool begun_ = false;  ///< a document has begun
  std::size_t values_ = 0;
  std::vector<Open> open_;
  /// Number of values that an anchor names, once complete.
  std::unordered_map<YAML::anchor_t, std::size_t> sizes_;
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
