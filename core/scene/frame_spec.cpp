// SPDX-License-Identifier: BSD-3-Clause
#include "core/scene/frame_spec.h"

#include <charconv>
#include <map>
#include <optional>
#include <set>
#include <sstream>

#include "core/base/outcome.h"

namespace glint {
namespace {

std::optional<int> wholeNumber(const std::string& text) {
  int value = 0;
  const auto [end, error] = std::from_chars(text.data(), text.data() + text.size(), value);
  if (error != std::errc() || end != text.data() + text.size() || value < 0) return std::nullopt;
  return value;
}

}  // namespace

std::vector<int> parseFrames(const std::string& text, const Scene& scene, const std::string& flag) {
  const int n = static_cast<int>(scene.frames.size());
  const auto bad = [&](const std::string& why) { return InputError("", flag + " " + text, why); };
  if (text.rfind("first:", 0) == 0 || text.rfind("spread:", 0) == 0) {
    const std::size_t colon = text.find(':');
    const std::string kind = text.substr(0, colon);
    const std::optional<int> k = wholeNumber(text.substr(colon + 1));
    if (!k) throw bad("expected first:K or spread:K");
    if (*k < 1 || *k > n) throw bad("the input has " + std::to_string(n) + " frames");
    std::vector<int> frames;
    for (int i = 0; i < *k; ++i) frames.push_back(kind == "first" ? i : static_cast<int>(static_cast<long long>(i) * n / *k));
    return frames;
  }
  // Frame ids win over numbers: "0003" may be an id or the number 3. Numbers are positions in the input.
  std::map<std::string, int> ids;
  for (int i = 0; i < n; ++i) ids[scene.frames[i].id] = i;
  const auto frameOf = [&](const std::string& word) {
    if (const auto it = ids.find(word); it != ids.end()) return it->second;
    const std::optional<int> number = wholeNumber(word);
    if (!number && word.find(':') != std::string::npos) throw bad("expected first:K or spread:K");
    if (!number) throw bad("'" + word + "' is neither a frame id nor a number");
    if (*number >= n)
      throw bad("frame " + word + " does not exist; frames are numbered 0 to " + std::to_string(n - 1) +
                " in their order, and no id is \"" + word + "\"");
    return *number;
  };
  if (!text.empty() && text.back() == ',') throw bad("empty entry");
  std::set<int> frames;
  std::stringstream stream(text);
  std::string word;
  while (std::getline(stream, word, ',')) {
    if (word.empty()) throw bad("empty entry");
    if (ids.count(word)) {
      frames.insert(ids[word]);
      continue;
    }
    // Ids may hold dashes: the one that leaves a frame on either side separates.
    std::size_t dash = word.find('-', 1);
    const auto names = [&](const std::string& part) { return ids.count(part) || wholeNumber(part); };
    for (std::size_t d = dash; d != std::string::npos; d = word.find('-', d + 1))
      if (names(word.substr(0, d)) && names(word.substr(d + 1))) dash = d;
    if (dash == std::string::npos) {
      frames.insert(frameOf(word));
      continue;
    }
    const int from = frameOf(word.substr(0, dash)), to = frameOf(word.substr(dash + 1));
    if (to < from) throw bad("the range " + word + " runs backwards");
    for (int i = from; i <= to; ++i) frames.insert(i);
  }
  if (frames.empty()) throw bad("names no frame");
  return {frames.begin(), frames.end()};
}

std::string frameSpec(const std::vector<int>& frames, const Scene& scene) {
  std::map<std::string, int> ids;
  for (int i = 0; i < static_cast<int>(scene.frames.size()); ++i) ids[scene.frames[static_cast<std::size_t>(i)].id] = i;
  const auto isOwn = [&](const std::string& word, int frame) {
    const auto it = ids.find(word);
    return it == ids.end() || it->second == frame;
  };
  std::string text;
  for (std::size_t i = 0; i < frames.size();) {
    if (!text.empty()) text += ',';
    const std::string from = std::to_string(frames[i]);
    std::size_t j = i;
    while (j + 1 < frames.size() && frames[j + 1] == frames[j] + 1) ++j;
    if (j > i) {
      const std::string to = std::to_string(frames[j]), range = from + '-' + to;
      if (isOwn(from, frames[i]) && isOwn(to, frames[j]) && !ids.count(range)) {
        text += range;
        i = j + 1;
        continue;
      }
    }
    text += isOwn(from, frames[i]) ? from : scene.frames[static_cast<std::size_t>(frames[i])].id;
    ++i;
  }
  return text;
}

}  // namespace glint
