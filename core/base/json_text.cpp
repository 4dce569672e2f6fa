// SPDX-License-Identifier: BSD-3-Clause
#include "core/base/json_text.h"

#include <cmath>
#include <limits>
#include <unordered_map>

#include "core/base/atomic_file.h"
#include "core/base/json_dom.h"
#include "core/base/outcome.h"

namespace glint {

using json_dom::Json;

struct JsonNode::Document {
  Json root;
  std::string file;
  /// Members of the objects with many: the JSON library looks through all keys for one.
  std::unordered_map<const Json*, std::unordered_map<std::string, const Json*>> members;

  void index(const Json& value) {
    constexpr std::size_t kMany = 16;  // below, looking through is as fast
    if (value.is_array())
      for (const Json& element : value)
        if (element.is_structured()) index(element);
    if (!value.is_object()) return;
    auto* own = value.size() > kMany ? &members[&value] : nullptr;
    for (const auto& [key, member] : value.get_ref<const Json::object_t&>()) {
      if (own) own->emplace(key, &member);
      if (member.is_structured()) index(member);
    }
  }
  const Json* find(const Json& object, const std::string& key) const {
    if (const auto many = members.find(&object); many != members.end()) {
      const auto member = many->second.find(key);
      return member == many->second.end() ? nullptr : member->second;
    }
    const auto member = object.find(key);
    return member == object.end() ? nullptr : &*member;
  }
};

namespace {

const Json& json(const void* value) { return *static_cast<const Json*>(value); }

const char* typeName(const Json& j) {
  if (j.is_object()) return "an object";
  if (j.is_array()) return "a list";
  if (j.is_string()) return "text";
  if (j.is_boolean()) return "true or false";
  if (j.is_null()) return "null (or NaN)";
  return "a number";
}

/// NaN, Infinity and -Infinity outside strings become null.
std::string withoutNonFinite(const std::string& text) {
  if (text.find("NaN") == std::string::npos && text.find("Infinity") == std::string::npos) return text;
  std::string out;
  out.reserve(text.size());
  bool inString = false;
  for (std::size_t i = 0; i < text.size(); ++i) {
    const char c = text[i];
    if (inString) {
      out += c;
      if (c == '\\' && i + 1 < text.size()) out += text[++i];
      if (c == '"') inString = false;
      continue;
    }
    bool replaced = false;
    for (const char* word : {"NaN", "-NaN", "Infinity", "-Infinity"}) {
      const std::size_t n = std::char_traits<char>::length(word);
      if (text.compare(i, n, word) == 0) {
        out += "null";
        i += n - 1;
        replaced = true;
        break;
      }
    }
    if (replaced) continue;
    if (c == '"') inString = true;
    out += c;
  }
  return out;
}

std::string childPlace(const std::string& place, const std::string& key) { return place.empty() ? key : place + "." + key; }

}  // namespace

JsonNode::JsonNode(std::shared_ptr<const Document> document, const void* value, std::string place)
    : document_(std::move(document)), value_(value), place_(std::move(place)) {}

const Json& json_dom::NodeValue::of(const JsonNode& node) { return json(node.value_); }

JsonNode JsonNode::parse(const std::string& text, const std::string& file) {
  const auto document = std::make_shared<Document>();
  document->file = file;
  document->root = json_dom::parse(withoutNonFinite(text), file);
  document->index(document->root);
  const void* root = &document->root;
  return JsonNode(document, root, "");
}

bool JsonNode::isObject() const { return json(value_).is_object(); }
bool JsonNode::isArray() const { return json(value_).is_array(); }
bool JsonNode::isNull() const { return json(value_).is_null(); }
bool JsonNode::isString() const { return json(value_).is_string(); }
bool JsonNode::isNumber() const { return json(value_).is_number(); }
bool JsonNode::isBoolean() const { return json(value_).is_boolean(); }
const std::string& JsonNode::file() const { return document_->file; }

void JsonNode::fail(const std::string& reason) const { throw InputError(document_->file, place_, reason); }

namespace {
std::string wrongType(const char* expected, const Json& j) { return std::string("must be ") + expected + ", is " + typeName(j); }
}  // namespace

bool JsonNode::has(const std::string& key) const {
  if (!isObject()) fail(wrongType("an object", json(value_)));
  return document_->find(json(value_), key) != nullptr;
}

std::optional<JsonNode> JsonNode::find(const std::string& key) const {
  if (!isObject()) fail(wrongType("an object", json(value_)));
  const Json* member = document_->find(json(value_), key);
  if (member == nullptr) return std::nullopt;
  return JsonNode(document_, member, childPlace(place_, key));
}

JsonNode JsonNode::at(const std::string& key) const {
  std::optional<JsonNode> node = find(key);
  if (!node) throw InputError(document_->file, childPlace(place_, key), "is missing");
  return *node;
}

std::vector<std::string> JsonNode::keys() const {
  if (!isObject()) fail(wrongType("an object", json(value_)));
  std::vector<std::string> keys;
  for (const auto& item : json(value_).items()) keys.push_back(item.key());
  return keys;
}

std::size_t JsonNode::size() const {
  if (!isArray()) fail(wrongType("a list", json(value_)));
  return json(value_).size();
}

JsonNode JsonNode::at(std::size_t index) const {
  require(index < size(), "JsonNode::at: no such element");
  return JsonNode(document_, &json(value_).at(index), place_ + "[" + std::to_string(index) + "]");
}

double JsonNode::number() const {
  if (!json(value_).is_number()) fail(wrongType("a finite number", json(value_)));
  const double v = json(value_).get<double>();
  if (!std::isfinite(v)) fail("must be a finite number");
  return v;
}

int JsonNode::integer() const {
  const double v = number();
  if (v != std::floor(v) || v < std::numeric_limits<int>::min() || v > std::numeric_limits<int>::max())
    fail("must be a whole number");
  return static_cast<int>(v);
}

bool JsonNode::boolean() const {
  if (!json(value_).is_boolean()) fail(wrongType("true or false", json(value_)));
  return json(value_).get<bool>();
}

std::string JsonNode::text() const {
  if (!json(value_).is_string()) fail(wrongType("text", json(value_)));
  return json(value_).get<std::string>();
}

std::vector<double> JsonNode::numbers() const {
  std::vector<double> values;
  const std::size_t n = size();
  for (std::size_t i = 0; i < n; ++i) values.push_back(at(i).number());
  return values;
}

namespace {
template <int N>
Eigen::Matrix<double, N, 1> fixedVector(const JsonNode& node) {
  if (node.size() != N) node.fail("must have " + std::to_string(N) + " numbers, has " + std::to_string(node.size()));
  Eigen::Matrix<double, N, 1> v;
  for (int i = 0; i < N; ++i) v[i] = node.at(static_cast<std::size_t>(i)).number();
  return v;
}
}  // namespace

Eigen::Vector2d JsonNode::vector2() const { return fixedVector<2>(*this); }
Eigen::Vector3d JsonNode::vector3() const { return fixedVector<3>(*this); }
Eigen::Matrix4d JsonNode::matrix4() const {
  if (size() != 4) fail("must have 4 rows of 4 numbers, has " + std::to_string(size()));
  Eigen::Matrix4d m;
  for (int i = 0; i < 4; ++i) m.row(i) = fixedVector<4>(at(static_cast<std::size_t>(i))).transpose();
  return m;
}

std::vector<std::string> JsonNode::unknownKeys(const std::set<std::string>& known) const {
  std::vector<std::string> unknown;
  for (const std::string& key : keys())
    if (!known.count(key)) unknown.push_back(key);
  return unknown;
}

std::string JsonNode::dump() const { return json(value_).dump(-1, ' ', false, Json::error_handler_t::replace); }

std::string documentKind(const std::filesystem::path& file) {
  try {
    const json_dom::Json root = json_dom::parse(readFile(file, Limit::JsonMegabytes), file.string());
    if (!root.is_object()) return "";
    for (const auto& [key, value] : root.items())
      if (key.rfind("glint_", 0) == 0 && value.is_number_integer()) return key;
  } catch (const std::exception&) {
    // Whatever it is, it is no document of ours.
  }
  return "";
}

}  // namespace glint
