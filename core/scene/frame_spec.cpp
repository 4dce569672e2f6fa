// SPDX-License-Identifier: BSD-3-Clause
#include <charconv>
#include <map>
#include <optional>
#include <set>
#include <sstream>
#include <utility>

#include "core/base/outcome.h"
#include "core/scene/frame_name.h"

namespace glint {
namespace {

std::optional<int> wholeNumber(const std::string& text) {
  int value = 0;
  const auto [end, error] = std::from_chars(text.data(), text.data() + text.size(), value);
  if (error != std::errc() || end != text.data() + text.size() || value < 0) return std::nullopt;
  return value;
}

bool isRule(const std::string& text) { return text.rfind("first:", 0) == 0 || text.rfind("spread:", 0) == 0; }

/// The words of a SPEC between its commas. Frame ids win over numbers: "0003" may be an id or the number 3. Numbers are positions
/// in the input.
class FrameWords {
 public:
  explicit FrameWords(const Scene& scene) {
    for (const Frame& f : scene.frames) ids_[f.id] = n_++;
  }

  /// The first and the last frame of a word. Nothing where it names none, with the reason in `why`.
  std::optional<std::pair<int, int>> read(const std::string& word, std::string& why) const {
    if (word.empty()) return failed(why, "empty entry");
    if (const auto it = ids_.find(word); it != ids_.end()) return std::pair(it->second, it->second);
    // Ids may hold dashes: the one that leaves a frame on either side separates.
    std::size_t dash = word.find('-', 1);
    const auto names = [&](const std::string& part) { return ids_.count(part) || wholeNumber(part); };
    for (std::size_t d = dash; d != std::string::npos; d = word.find('-', d + 1))
      if (names(word.substr(0, d)) && names(word.substr(d + 1))) dash = d;
    const std::optional<int> from = frameOf(word.substr(0, dash), why);
    if (!from || dash == std::string::npos) return from ? std::optional(std::pair(*from, *from)) : std::nullopt;
    const std::optional<int> to = frameOf(word.substr(dash + 1), why);
    if (to && *to < *from) return failed(why, "the range " + word + " runs backwards");
    return to ? std::optional(std::pair(*from, *to)) : std::nullopt;
  }

  /// Whether a SPEC may have this word for exactly these frames.
  bool means(const std::string& word, int from, int to) const {
    std::string ignored;
    return !isRule(word) && word.find(',') == std::string::npos && read(word, ignored) == std::pair(from, to);
  }

 private:
  static std::nullopt_t failed(std::string& why, std::string reason) {
    why = std::move(reason);
    return std::nullopt;
  }

  std::optional<int> frameOf(const std::string& word, std::string& why) const {
    if (const auto it = ids_.find(word); it != ids_.end()) return it->second;
    const std::optional<int> number = wholeNumber(word);
    if (!number && word.find(':') != std::string::npos) return failed(why, "expected first:K or spread:K");
    if (!number) return failed(why, "'" + word + "' is neither a frame id nor a number");
    if (*number >= n_)
      return failed(why, "frame " + word + " does not exist; frames are numbered 0 to " + std::to_string(n_ - 1) +
                             " in their order, and no id is \"" + word + "\"");
    return *number;
  }

  int n_ = 0;
  std::map<std::string, int> ids_;
};

}  // namespace

std::vector<int> parseFrames(const std::string& text, const Scene& scene, const std::string& flag) {
  const int n = static_cast<int>(scene.frames.size());
  const auto bad = [&](const std::string& why) { return InputError("", flag + " " + text, why); };
  if (isRule(text)) {
    const std::size_t colon = text.find(':');
    const std::string kind = text.substr(0, colon);
    const std::optional<int> k = wholeNumber(text.substr(colon + 1));
    if (!k) throw bad("expected first:K or spread:K");
    if (*k < 1 || *k > n) throw bad("the input has " + std::to_string(n) + " frames");
    std::vector<int> frames;
    for (int i = 0; i < *k; ++i) frames.push_back(kind == "first" ? i : static_cast<int>(static_cast<long long>(i) * n / *k));
    return frames;
  }
  if (!text.empty() && text.back() == ',') throw bad("empty entry");
  const FrameWords words(scene);
  std::set<int> frames;
  std::stringstream stream(text);
  std::string word, why;
  while (std::getline(stream, word, ',')) {
    const std::optional<std::pair<int, int>> range = words.read(word, why);
    if (!range) throw bad(why);
    for (int i = range->first; i <= range->second; ++i) frames.insert(i);
  }
  if (frames.empty()) throw bad("names no frame");
  return {frames.begin(), frames.end()};
}

std::string frameSpec(const std::vector<int>& frames, const Scene& scene) {
  const FrameWords words(scene);
  const auto id = [&](int frame) { return scene.frames[static_cast<std::size_t>(frame)].id; };
  // The word for frames that follow each other, by ids where that reads back and else by numbers; "" where neither does.
  const auto wordFor = [&](int from, int to) -> std::string {
    for (const auto& [a, b] : {std::pair(id(from), id(to)), std::pair(std::to_string(from), std::to_string(to))})
      if (const std::string word = from == to ? a : a + '-' + b; words.means(word, from, to)) return word;
    return "";
  };
  std::string text;
  for (std::size_t i = 0; i < frames.size();) {
    std::size_t j = i;
    while (j + 1 < frames.size() && frames[j + 1] == frames[j] + 1) ++j;
    std::string word = wordFor(frames[i], frames[j]);
    if (word.empty() && j > i) word = wordFor(frames[i], frames[j = i]);
    text += (text.empty() ? "" : ",") + (word.empty() ? id(frames[i]) : word);
    i = j + 1;
  }
  return text;
}

}  // namespace glint
