// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <algorithm>
#include <string>

#include "core/base/json_text.h"

namespace glint {

/// A name of a frame, light or surface: not empty, no control characters.
inline bool isIdentifier(const std::string& id) {
  return !id.empty() &&
         std::none_of(id.begin(), id.end(), [](char c) { return static_cast<unsigned char>(c) < 0x20 || c == 0x7F; });
}

/// @throw InputError with file and place
inline std::string readIdJson(const JsonNode& node) {
  const std::string id = node.text();
  if (id.empty()) node.fail("must not be empty");
  if (!isIdentifier(id)) node.fail("must not contain control characters");
  return id;
}

}  // namespace glint
