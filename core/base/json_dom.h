// SPDX-License-Identifier: BSD-3-Clause
#pragma once

// Internal to core: the JSON library's document, in time proportional to the text. Its own parser looks through all keys of an
// object for every new one, so that an object of 100,000 keys takes many seconds.

#include <cmath>
#include <nlohmann/json.hpp>
#include <string>

namespace glint {
class JsonNode;
}

namespace glint::json_dom {

using Json = nlohmann::ordered_json;

/// JSON has no NaN and no infinity: null stands for both.
inline Json numberOrNull(double v) { return std::isfinite(v) ? Json(v) : Json(); }

/// Appends a member; the caller knows that the key is new. (`object[key]` looks through all keys first.)
inline void append(Json& object, const std::string& key, Json value) {
  if (object.is_null()) object = Json::object();
  auto& members = object.get_ref<Json::object_t&>();
  static_cast<Json::object_t::Container&>(members).emplace_back(key, std::move(value));
}

/// The text for people: two blanks a level, arrays of numbers (and of short arrays of numbers) on one line. Bytes that are not
/// UTF-8 are replaced, numbers that are not finite become null.
std::string pretty(const Json& document);
/// The same of a document that names files. @param file  that it will be
/// @throw InputError if a path or name is not UTF-8: JSON could hold another one only, and nothing would be found there.
std::string prettyWithPaths(const Json& document, const std::string& file);

/// `file` names the text in messages.
/// @throw InputError (file; line and column, or the place of the value) for wrong syntax, a repeated key in an object,
///        nesting deeper than 100, and beyond the limits json.megabytes and json.values.
Json parse(const std::string& text, const std::string& file);

/// The value at a place of a document that was read, which lives as long as the place.
struct NodeValue {
  static const Json& of(const JsonNode& node);
};

}  // namespace glint::json_dom
