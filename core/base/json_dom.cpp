// SPDX-License-Identifier: BSD-3-Clause
#include "core/base/json_dom.h"

#include <cctype>
#include <unordered_set>
#include <vector>

#include "core/base/limits.h"
#include "core/base/outcome.h"

namespace glint::json_dom {
namespace {

constexpr std::size_t kShort = 15, kFewKeys = 16;  // letters that a text holds in itself; keys that are not indexed (JsonNode)
constexpr int kDeepest = 100;  // no format of ours nests deeper than 8; recursion over hostile files stays harmless

/// "line 3, column 5" and the rest of the JSON library's message, which starts with an identifier and a position.
std::pair<std::string, std::string> splitParseMessage(const std::string& message) {
  std::string place = "JSON", reason = message;
  if (const std::size_t at = message.find("at line "); at != std::string::npos) {
    const std::size_t end = message.find(": ", at);
    place = message.substr(at + 3, end == std::string::npos ? std::string::npos : end - at - 3);
    if (end != std::string::npos) reason = message.substr(end + 2);
  } else if (const std::size_t bracket = message.find("] "); bracket != std::string::npos) {
    reason = message.substr(bracket + 2);
  }
  for (char& c : reason)
    if (std::iscntrl(static_cast<unsigned char>(c))) c = ' ';
  return {place, "not valid JSON: " + reason};
}

/// Builds the document from the library's events. A value under construction is moved into its parent when it ends, so no pointer
/// into a growing list is kept.
class Builder final : public nlohmann::json_sax<Json> {
 public:
  explicit Builder(const std::string& file) : file_(file) {}
  Json root;

  bool null() override { return add(nullptr); }
  bool boolean(bool v) override { return add(v); }
  bool number_integer(number_integer_t v) override { return add(v); }
  bool number_unsigned(number_unsigned_t v) override { return add(v); }
  bool number_float(number_float_t v, const string_t&) override { return add(v); }
  bool string(string_t& v) override {
    constexpr double kString = 48;  // bytes, with what the system keeps of it
    cost(kString + ofText(v));
    return add(std::move(v));
  }
  bool binary(binary_t&) override { return false; }  // JSON text has none
  bool start_object(std::size_t) override { return begin(Json::object()); }
  bool start_array(std::size_t) override { return begin(Json::array()); }
  bool end_object() override { return end(); }
  bool end_array() override { return end(); }
  bool key(string_t& v) override {
    Level& level = levels_.back();
    level.key = v;
    constexpr double kMember = 32,
                     kIndexed = 72;  // bytes: the name beside its value; its place in an index, where there are many
    cost(kMember + ofText(v) + (level.keys.size() >= kFewKeys ? kIndexed : 0));
    if (!level.keys.insert(v).second) throw InputError(file_, where(), "duplicate key");
    return true;
  }
  bool parse_error(std::size_t, const std::string&, const nlohmann::detail::exception& e) override {
    const auto [place, reason] = splitParseMessage(e.what());
    throw InputError(file_, place, reason);
  }

 private:
  struct Level {
    Json value;
    std::string key;
    std::unordered_set<std::string> keys;
  };

  std::string where() const {
    std::string place;
    for (const Level& l : levels_)
      if (!l.key.empty()) place += (place.empty() ? "" : ".") + l.key;
    return place;
  }
  /// Bytes of a text that does not fit into its object.
  static double ofText(const std::string& text) { return text.size() > kShort ? double(text.size()) : 0; }
  /// A text of some megabytes may take a hundred times as much when it is read.
  void cost(double bytes) {
    constexpr double kMegabyte = 1e6;
    bytes_ += bytes;
    requireWithin(Limit::JsonMemory, bytes_ / kMegabyte, file_);
  }
  bool add(Json value) {
    requireWithin(Limit::JsonValues, double(++values_), file_);
    cost(sizeof(Json));
    if (levels_.empty())
      root = std::move(value);
    else if (levels_.back().value.is_array())
      levels_.back().value.push_back(std::move(value));
    else
      append(levels_.back().value, levels_.back().key, std::move(value));
    return true;
  }
  bool begin(Json empty) {
    if (levels_.size() >= std::size_t(kDeepest))
      throw InputError(file_, "JSON", "nested deeper than " + std::to_string(kDeepest) + " levels");
    constexpr double kList = 64;  // bytes: the list and its first block
    cost(kList);
    levels_.push_back({std::move(empty), "", {}});
    return true;
  }
  bool end() {
    Json done = std::move(levels_.back().value);
    levels_.pop_back();
    return add(std::move(done));
  }

  const std::string& file_;
  std::vector<Level> levels_;
  std::size_t values_ = 0;
  double bytes_ = 0;
};

}  // namespace

namespace {

/// A scalar, or a list of at most 16 scalars without text: what fits on a line.
bool isShort(const Json& j) {
  if (j.is_object()) return j.empty();
  if (!j.is_array()) return true;
  if (j.size() > 16) return false;
  for (const Json& e : j)
    if (e.is_structured()) return false;
  return true;
}

void print(const Json& j, int depth, std::string& out) {
  const std::string indent(static_cast<std::size_t>(2 * depth), ' ');
  if (!j.is_structured() || j.empty()) {
    out += j.dump(-1, ' ', false, Json::error_handler_t::replace);
  } else if (j.is_object()) {
    out += "{\n";
    bool first = true;
    for (const auto& item : j.items()) {
      if (!first) out += ",\n";
      first = false;
      out += indent + "  " + Json(item.key()).dump(-1, ' ', false, Json::error_handler_t::replace) + ": ";
      print(item.value(), depth + 1, out);
    }
    out += "\n" + indent + "}";
  } else {
    bool flat = true;
    for (const Json& e : j) flat = flat && isShort(e);
    bool first = true;
    out += "[";
    for (const Json& e : j) {
      if (!first) out += flat ? ", " : ",";
      first = false;
      if (flat) {
        out += e.dump(-1, ' ', false, Json::error_handler_t::replace);
      } else {
        out += "\n" + indent + "  ";
        print(e, depth + 1, out);
      }
    }
    if (!flat) out += "\n" + indent;
    out += "]";
  }
}

}  // namespace

std::string pretty(const Json& document) {
  std::string out;
  print(document, 0, out);
  return out + "\n";
}

std::string prettyWithPaths(const Json& document, const std::string& file) {
  try {
    static_cast<void>(document.dump(-1, ' ', false, Json::error_handler_t::strict));
    return pretty(document);
  } catch (const Json::type_error&) {
    throw InputError(file, "",
                     "cannot be written: it names a file or folder whose path is not UTF-8; rename that file or folder");
  }
}

Json parse(const std::string& text, const std::string& file) {
  constexpr double kMegabyte = 1e6;
  requireWithin(Limit::JsonMegabytes, double(text.size()) / kMegabyte, file);
  Builder builder(file);
  Json::sax_parse(text, &builder);
  return std::move(builder.root);
}

}  // namespace glint::json_dom
