// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <algorithm>
#include <cctype>
#include <string>
#include <string_view>

namespace glint {

/// Whether an id says by itself that it is a light: it is that word or begins with it, "light", "Light_2"; not "lighthouse".
inline bool saysLight(const std::string& id) {
  constexpr std::string_view kWord = "light";
  const auto lower = [](char c) { return static_cast<char>(std::tolower(static_cast<unsigned char>(c))); };
  if (id.size() < kWord.size() ||
      !std::equal(kWord.begin(), kWord.end(), id.begin(), [&](char w, char c) { return w == lower(c); }))
    return false;
  return id.size() == kWord.size() || std::isalpha(static_cast<unsigned char>(id[kWord.size()])) == 0;
}

/// A light within a sentence: "light 3"; the id alone where that says it, to avoid "light light".
inline std::string lightName(const std::string& id) { return saysLight(id) ? id : "light " + id; }

}  // namespace glint
