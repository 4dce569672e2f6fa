// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <Eigen/Core>
#include <filesystem>
#include <memory>
#include <optional>
#include <set>
#include <string>
#include <vector>

namespace glint {

namespace json_dom {
struct NodeValue;  // core/base/json_dom.h
}

/// A place in a JSON document, with checked reading: every error is an InputError `file: place: reason`, where place is
/// a path such as `frames[3].camera_from_world` (or line and column for wrong syntax). Cheap to copy; the document lives
/// as long as one of its places. Keeps the JSON library out of headers.
class JsonNode {
 public:
  /// Syntax errors name line and column; a repeated key in an object and nesting deeper than 100 are refused.
  /// NaN and Infinity, which some programs write although JSON has none, read as null, so that the error names their place.
  static JsonNode parse(const std::string& text, const std::string& file);

  bool isObject() const;
  bool isArray() const;
  bool isNull() const;
  bool isString() const;
  bool isNumber() const;
  bool isBoolean() const;

  /// Members and elements. `at` throws when it is missing; both throw when this is not an object (an array).
  bool has(const std::string& key) const;
  JsonNode at(const std::string& key) const;
  std::optional<JsonNode> find(const std::string& key) const;  ///< nothing if the key is missing
  std::vector<std::string> keys() const;                       ///< in the order of the file
  std::size_t size() const;                                    ///< elements of an array
  JsonNode at(std::size_t index) const;

  /// Scalars; InputError on another type ("must be a number, is a string"). A number is finite.
  double number() const;
  int integer() const;
  bool boolean() const;
  std::string text() const;
  /// Arrays of numbers of exactly this length.
  std::vector<double> numbers() const;
  Eigen::Vector2d vector2() const;
  Eigen::Vector3d vector3() const;
  Eigen::Matrix4d matrix4() const;  ///< four rows of four numbers

  /// Keys of this object that are not in `known`, in the order of the file.
  std::vector<std::string> unknownKeys(const std::set<std::string>& known) const;
  std::string dump() const;  ///< compact JSON of this value
  const std::string& place() const { return place_; }
  const std::string& file() const;
  /// An error about this place.
  [[noreturn]] void fail(const std::string& reason) const;

 private:
  friend struct json_dom::NodeValue;
  struct Document;
  JsonNode(std::shared_ptr<const Document> document, const void* value, std::string place);
  std::shared_ptr<const Document> document_;
  const void* value_;  // nlohmann::ordered_json
  std::string place_;
};

/// What a JSON file is, by the key at its top that names its format: "glint_scene", "glint_session", "glint_evaluation" and so
/// on. "" if the file is missing, is no regular file, cannot be read or parsed, or has no such key. Never throws.
std::string documentKind(const std::filesystem::path& file);

}  // namespace glint
