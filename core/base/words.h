// SPDX-License-Identifier: BSD-3-Clause
#pragma once

// Parts of sentences that a person reads.
#include <algorithm>
#include <cctype>
#include <string>
#include <string_view>
#include <vector>

namespace glint {

/// How a refusal of an unknown model, lobe, surface, reader or layer ends: it may be one that a plugin adds, and neither sessions
/// nor scenes say which plugins they were made with.
inline constexpr const char* kPluginHint = "; if a plugin adds it, give --plugin FILE";

/// A unit as windows and pictures write it; settings, terminals and files keep plain ASCII.
inline std::string writtenUnit(const std::string& unit) { return unit == "px^2" ? "px²" : unit == "deg" ? "°" : unit; }

/// What follows a number: " px", but "°" without a blank, as the SI writes angles; "" without a unit.
inline std::string unitAfterNumber(const std::string& unit) {
  const std::string written = writtenUnit(unit);
  return written.empty() || written == "°" ? written : " " + written;
}

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

/// "0, 3, 7 and 5 more": at most eight of these words.
inline std::string shortList(const std::vector<std::string>& words) {
  constexpr std::size_t kNamed = 8;  // more than a reader compares at a glance
  std::string text;
  for (std::size_t i = 0; i < std::min(kNamed, words.size()); ++i) text += (i ? ", " : "") + words[i];
  if (words.size() > kNamed) text += " and " + std::to_string(words.size() - kNamed) + " more";
  return text;
}

inline std::string shortList(const std::vector<int>& numbers) {
  std::vector<std::string> words;
  for (const int number : numbers) words.push_back(std::to_string(number));
  return shortList(words);
}

/// Insertions, deletions, replacements and swaps of neighbours that turn one text into another, byte by byte (optimal string
/// alignment: edits no part twice). @see Damerau, A technique for computer detection and correction of spelling errors, 1964.
int editDistance(const std::string& a, const std::string& b);

/// The known name that was most likely meant: the nearest one, where at most a third of the given name is wrong; the first of
/// equally near ones. "" if none is near, and for names beyond 100 bytes, which people do not type.
std::string similarName(const std::string& given, const std::vector<std::string>& known);

/// "; did you mean 'NAME'?", "" if no name is near.
std::string didYouMean(const std::string& given, const std::vector<std::string>& known);

}  // namespace glint
