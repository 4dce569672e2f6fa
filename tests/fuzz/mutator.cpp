// SPDX-License-Identifier: BSD-3-Clause
#include "tests/fuzz/mutator.h"

#include <algorithm>
#include <cstdint>
#include <cstring>
#include <nlohmann/json.hpp>

namespace glint::fuzz {
namespace {

using Json = nlohmann::ordered_json;

/// Numbers at which arithmetic, casts and sizes break, as JSON or as a word of a text. Some are no JSON (NaN), as other programs
/// write it.
const std::vector<std::string> kNumbers = {"0",
                                           "-0.0",
                                           "1",
                                           "-1",
                                           "2",
                                           "0.5",
                                           "-0.5",
                                           "1e308",
                                           "-1e308",
                                           "1e-308",
                                           "5e-324",
                                           "1e999",
                                           "-1e999",
                                           "NaN",
                                           "Infinity",
                                           "-Infinity",
                                           "9e18",
                                           "-9e18",
                                           "255",
                                           "256",
                                           "65535",
                                           "65536",
                                           "65537",
                                           "2147483647",
                                           "2147483648",
                                           "-2147483648",
                                           "-2147483649",
                                           "4294967295",
                                           "4294967296",
                                           "1e9",
                                           "1e20",
                                           "-1e20",
                                           "1e-9",
                                           "1e-20",
                                           "0.1e1",
                                           "3.0000000001",
                                           "100000",
                                           "1000000",
                                           "9223372036854775807",
                                           "18446744073709551616",
                                           "nan",
                                           "1e30",
                                           "1e16",
                                           "0x10",
                                           "1,5",
                                           "00012",
                                           "+1",
                                           ".5",
                                           "1e",
                                           "--1",
                                           "0.3333333333",
                                           "12345678.9"};

const std::vector<std::string> kTexts = {"",
                                         ".",
                                         "..",
                                         "../..",
                                         "../x",
                                         "a/../../b",
                                         "/dev/zero",
                                         "/dev/stdin",
                                         "/proc/self/mem",
                                         "/nowhere/at/all.png",
                                         "~",
                                         "\x1b[2J\x1b[31mred",
                                         "two\nlines",
                                         "a\rb",
                                         std::string("zero\0byte", 9),
                                         "tab\there",
                                         "\xff\xfe\x80",
                                         "\xe2\x80\xaegnp.evil",
                                         "\xed\xa0\x80",
                                         "<b>bold</b>",
                                         "%s%n%99999d",
                                         "'; echo x; '",
                                         "a,b-c:d",
                                         "per-surface",
                                         "spread:0",
                                         "first:999999999999",
                                         "0-99999999",
                                         "limit-angle",
                                         "reflectance",
                                         "image",
                                         "con.png",
                                         "0000",
                                         "scene.json",
                                         "body.ply",
                                         "frames/0000.png"};

const std::vector<std::string> kKeys = {"x",       "",          "id",      "mesh",     "analytic", "camera",    "scale",
                                        "k1",      "frames",    "lights",  "surfaces", "image",    "depth",     "mask",
                                        "path",    "files",     "what_if", "truth",    "radius",   "semi_axes", "type",
                                        "segment", "direction", "matrix",  "levels",   "points"};

template <class T>
const T& oneOf(const std::vector<T>& all, Rng& rng) {
  return all[below(rng, all.size())];
}

std::string longText(Rng& rng) {
  constexpr std::size_t kLengths[] = {300, 5000, 70000};
  const char* const kParts[] = {"A", "../", "\xc3\xa4", "a ", "/"};
  const std::string part = kParts[below(rng, std::size(kParts))];
  const std::size_t length = kLengths[below(rng, std::size(kLengths))];
  std::string text;
  while (text.size() < length) text += part;
  return text;
}

std::string deepText(Rng& rng) {
  constexpr std::size_t kDepths[] = {50, 99, 101, 5000};
  const std::size_t depth = kDepths[below(rng, std::size(kDepths))];
  std::string text;
  if (below(rng, 2) == 0) {
    text = std::string(depth, '[') + std::string(depth, ']');
  } else {
    for (std::size_t i = 0; i < depth; ++i) text += "{\"a\":";
    text += "1" + std::string(depth, '}');
  }
  return text;
}

// ---- JSON

struct Place {
  Json* value;
  Json* parent;       // null for the root
  std::size_t index;  // in the parent
};

void collect(Json& value, Json* parent, std::size_t index, std::vector<Place>& all) {
  all.push_back({&value, parent, index});
  std::size_t i = 0;
  if (value.is_structured())
    for (Json& child : value) collect(child, &value, i++, all);
}

/// Damages a document. What JSON cannot hold (NaN, a key twice) stands in it as a mark until it is printed.
class JsonDamage {
 public:
  JsonDamage(Json& root, Rng& rng, const std::vector<std::string>& paths) : root_(root), rng_(rng), paths_(paths) {}

  void change() {
    std::vector<Place> all;
    collect(root_, nullptr, 0, all);
    const Place at = all[below(rng_, all.size())];
    switch (below(rng_, 16)) {
      case 0:
      case 1:
      case 2: number(*at.value); break;
      case 3:
      case 4: text(*at.value); break;
      case 5: otherType(*at.value); break;
      case 6: erase(at); break;
      case 7: repeat(at); break;
      case 8: swapOrCopy(*at.value, *oneOf(all, rng_).value); break;
      case 9: rename(at); break;
      case 10: insertInto(*at.value, *oneOf(all, rng_).value); break;
      case 11: shorten(*at.value); break;
      case 12: *at.value = marked(deepText(rng_)); break;
      default: nearby(all); break;
    }
  }

  std::string print() const {
    std::string out;
    try {
      out = root_.dump(below(rng_, 4) == 0 ? 1 : -1, ' ', false, Json::error_handler_t::ignore);
    } catch (const std::exception&) {
      return "";
    }
    for (std::size_t i = 0; i < raw_.size(); ++i) {
      const std::string mark = "\"" + markOf(i) + "\"";
      if (const std::size_t at = out.find(mark); at != std::string::npos) out.replace(at, mark.size(), raw_[i]);
    }
    return out;
  }

 private:
  static std::string markOf(std::size_t i) { return "@raw-" + std::to_string(i) + "@"; }
  Json marked(const std::string& raw) {
    raw_.push_back(raw);
    return markOf(raw_.size() - 1);
  }

  void number(Json& value) {
    if (value.is_number() && below(rng_, 3) == 0) {
      const double v = value.get<double>();
      const double kFactors[] = {-1, 2, 0.5, 10, 1e-3, 1e6, 1e15, 1e-12};
      value = v * kFactors[below(rng_, std::size(kFactors))];
      return;
    }
    value = marked(oneOf(kNumbers, rng_));
  }
  void text(Json& value) {
    const std::size_t which = below(rng_, 8);
    if (which == 0) {
      value = longText(rng_);
    } else if (which == 1 && !paths_.empty()) {
      value = oneOf(paths_, rng_);
    } else if (which == 2) {  // bytes that the printer would refuse
      std::string raw = "\"";
      for (std::size_t i = 0; i < 1 + below(rng_, 12); ++i) {
        const char c = static_cast<char>(below(rng_, 256));
        if (c != '"' && c != '\\') raw += c;
      }
      value = marked(raw + "\"");
    } else if (which == 3) {
      const char* const kEscapes[] = {"\"\\u0000\"", "\"\\ud800\"", "\"\\u001b[2J\"",    "\"\\u000a\"",
                                      "\"\\u202e\"", "\"\\x\"",     "\"\\ud83d\\ude00\""};
      value = marked(kEscapes[below(rng_, std::size(kEscapes))]);
    } else {
      value = oneOf(kTexts, rng_);
    }
  }
  void otherType(Json& value) {
    switch (below(rng_, 7)) {
      case 0: value = nullptr; break;
      case 1: value = true; break;
      case 2: value = Json::object(); break;
      case 3: value = Json::array(); break;
      case 4: value = Json::array({Json::array({Json::array()})}); break;
      case 5: value = Json::object({{"x", 1}}); break;
      default: value = "text"; break;
    }
  }
  void erase(const Place& at) {
    if (!at.parent) return;
    if (at.parent->is_array())
      at.parent->erase(at.index);
    else
      at.parent->erase(std::next(at.parent->begin(), static_cast<std::ptrdiff_t>(at.index)));
  }
  void repeat(const Place& at) {
    if (!at.parent) return;
    constexpr std::size_t kTimes[] = {1, 1, 2, 30, 2000};
    const std::size_t times = kTimes[below(rng_, std::size(kTimes))];
    const Json copy = *at.value;
    constexpr std::size_t kSmall = 20000;  // bytes of all copies together; more is the business of the limits' own tests
    const std::size_t size = copy.dump(-1, ' ', false, Json::error_handler_t::ignore).size() + 1;
    const std::size_t n = std::max<std::size_t>(1, std::min(times, kSmall / size));
    if (at.parent->is_array()) {
      for (std::size_t i = 0; i < n; ++i) at.parent->push_back(copy);
    } else if (below(rng_, 3) == 0) {  // the same key a second time
      const std::string key = std::next(at.parent->begin(), static_cast<std::ptrdiff_t>(at.index)).key();
      auto& members = at.parent->get_ref<Json::object_t&>();
      static_cast<Json::object_t::Container&>(members).emplace_back(key, copy);
    } else {
      for (std::size_t i = 0; i < n; ++i) (*at.parent)["copy" + std::to_string(i)] = copy;
    }
  }
  void swapOrCopy(Json& a, Json& b) {
    const Json copyA = a, copyB = b;  // one may lie inside the other
    const bool swap = below(rng_, 2) == 0;
    b = copyA;
    if (swap && !copyB.is_structured() && !copyA.is_structured()) a = copyB;
  }
  void rename(const Place& at) {
    if (!at.parent || !at.parent->is_object()) return;
    const std::size_t which = below(rng_, 5);
    const std::string added = which == 2 ? longText(rng_) : "";
    Json changed = Json::object();
    auto& members = static_cast<Json::object_t::Container&>(changed.get_ref<Json::object_t&>());
    std::size_t i = 0;
    for (const auto& [key, value] : at.parent->get_ref<const Json::object_t&>()) {
      const bool here = i++ == at.index;
      members.emplace_back(!here        ? key
                           : which == 0 ? oneOf(kTexts, rng_)
                           : which == 1 ? key + " "
                           : which == 2 ? added
                                        : oneOf(kKeys, rng_),
                           value);
    }
    *at.parent = std::move(changed);
  }
  void insertInto(Json& value, const Json& from) {
    const Json copy = from;
    if (value.is_array())
      value.push_back(copy);
    else if (value.is_object())
      value[below(rng_, 3) == 0 ? oneOf(kTexts, rng_) : oneOf(kKeys, rng_)] = copy;
  }
  void shorten(Json& value) {
    if (value.is_array() && !value.empty()) {
      const std::size_t keep = below(rng_, value.size());
      value.erase(value.begin() + static_cast<std::ptrdiff_t>(keep), value.end());
    } else if (value.is_object()) {
      value.clear();
    }
  }
  /// Members near the root decide most, and numbers are many: an upper member half of the time, else the number.
  void nearby(const std::vector<Place>& all) {
    Json* value = &root_;
    for (int depth = 0; depth < 3 && value->is_structured() && !value->empty(); ++depth)
      value = &*std::next(value->begin(), static_cast<std::ptrdiff_t>(below(rng_, value->size())));
    if (below(rng_, 2) == 0) value = oneOf(all, rng_).value;
    if (value->is_number())
      number(*value);
    else if (value->is_string())
      text(*value);
    else
      shorten(*value);
  }

  Json& root_;
  Rng& rng_;
  const std::vector<std::string>& paths_;
  std::vector<std::string> raw_;
};

/// Brackets that are open at once, in texts too, where they only make the number larger.
std::size_t nestingOf(const std::string& text) {
  std::size_t open = 0, most = 0;
  for (const char c : text) {
    if (c == '[' || c == '{') most = std::max(most, ++open);
    if ((c == ']' || c == '}') && open > 0) --open;
  }
  return most;
}

std::string mutatedJson(const std::string& input, Rng& rng, const std::vector<std::string>& paths) {
  // The library walks through a document by recursion: deeper ones would end this program, not the one under test.
  constexpr std::size_t kDeepest = 1000;
  if (nestingOf(input) > kDeepest) return mutatedBytes(input, rng);
  Json root = Json::parse(input, nullptr, false);
  if (root.is_discarded()) return mutatedBytes(input, rng);
  JsonDamage damage(root, rng, paths);
  for (std::size_t i = 0, n = 1 + below(rng, 3); i < n; ++i) damage.change();
  std::string out = damage.print();
  if (out.empty()) return mutatedBytes(input, rng);
  return below(rng, 12) == 0 ? mutatedBytes(std::move(out), rng) : out;
}

// ---- Text

std::vector<std::string> splitAt(const std::string& text, char separator) {
  std::vector<std::string> parts(1);
  for (const char c : text)
    if (c == separator)
      parts.emplace_back();
    else
      parts.back() += c;
  return parts;
}

std::string joined(const std::vector<std::string>& parts, char separator) {
  std::string text;
  for (std::size_t i = 0; i < parts.size(); ++i) text += (i ? std::string(1, separator) : "") + parts[i];
  return text;
}

void changeWord(std::vector<std::string>& lines, Rng& rng, const std::vector<std::string>& paths) {
  std::string& line = lines[below(rng, lines.size())];
  std::vector<std::string> words = splitAt(line, ' ');
  std::string& word = words[below(rng, words.size())];
  switch (below(rng, 10)) {
    case 0: word = splitAt(oneOf(lines, rng), ' ').front(); break;
    case 1: word += oneOf(kNumbers, rng); break;
    case 2: word.clear(); break;
    case 3: words.push_back(oneOf(kNumbers, rng)); break;
    case 4: words.push_back(word); break;
    case 5: word = below(rng, 4) == 0 && !paths.empty() ? oneOf(paths, rng) : oneOf(kTexts, rng); break;
    case 6: word = below(rng, 4) == 0 ? longText(rng) : oneOf(kNumbers, rng); break;
    default: {  // a number inside the word: "2/1/3", "first:6", "fit.views=3"
      const std::size_t from = word.find_first_of("0123456789");
      if (from == std::string::npos) {
        word = oneOf(kNumbers, rng);
        break;
      }
      std::size_t to = word.find_first_not_of("0123456789.", from);
      if (to == std::string::npos) to = word.size();
      word.replace(from, to - from, oneOf(kNumbers, rng));
    }
  }
  line = joined(words, ' ');
}

std::string mutatedText(const std::string& input, Rng& rng, const std::vector<std::string>& paths) {
  std::vector<std::string> lines = splitAt(input, '\n');
  for (std::size_t i = 0, n = 1 + below(rng, 4); i < n && !lines.empty(); ++i) {
    const std::size_t at = below(rng, lines.size());
    const auto place = lines.begin() + static_cast<std::ptrdiff_t>(at);
    switch (below(rng, 12)) {
      case 0: lines.erase(place); break;
      case 1: lines.insert(place, std::string(oneOf(lines, rng))); break;
      case 2: std::swap(lines[at], lines[below(rng, lines.size())]); break;
      case 3: lines.insert(place, below(rng, 2) + 1, longText(rng)); break;
      case 4: lines.insert(place, 200, std::string(lines[at])); break;
      case 5: lines.resize(at + 1); break;
      default: changeWord(lines, rng, paths); break;
    }
  }
  std::string out = joined(lines, '\n');
  return below(rng, 8) == 0 ? mutatedBytes(std::move(out), rng) : out;
}

}  // namespace

std::size_t below(Rng& rng, std::size_t n) { return n == 0 ? 0 : static_cast<std::size_t>(rng() % n); }

Rng rngOf(std::uint64_t seed, std::uint64_t number) {
  constexpr std::uint64_t kOdd = 0x9E3779B97F4A7C15u;  // neighbouring numbers give unlike seeds
  return Rng((seed + 1) * kOdd ^ (number + 1) * 0xD1B54A32D192ED03u);
}

std::string mutatedBytes(std::string bytes, Rng& rng) {
  const std::size_t size = bytes.size(), at = below(rng, size), length = std::min(size - at, below(rng, 64) + 1);
  if (size == 0) return std::string(below(rng, 8), static_cast<char>(below(rng, 256)));
  switch (below(rng, 10)) {
    case 0: bytes[at] = static_cast<char>(bytes[at] ^ (1 << below(rng, 8))); break;
    case 1: bytes[at] = static_cast<char>(below(rng, 256)); break;
    case 2: bytes.erase(at, length); break;
    case 3: bytes.insert(at, bytes.substr(at, length)); break;
    case 4: bytes.resize(at); break;
    case 5: {
      std::string noise(length, '\0');
      for (char& c : noise) c = static_cast<char>(below(rng, 256));
      bytes.insert(at, noise);
      break;
    }
    case 6: {
      const std::size_t to = below(rng, size);
      const std::string block = bytes.substr(at, length);
      bytes.replace(to, std::min(block.size(), size - to), block);
      break;
    }
    case 7:
      std::fill_n(bytes.begin() + static_cast<std::ptrdiff_t>(at), length, static_cast<char>(below(rng, 2) ? 0xff : 0));
      break;
    default: {  // a number of 1, 2, 4 or 8 bytes, of either order
      const std::uint64_t kValues[] = {0,
                                       1,
                                       0x7f,
                                       0x80,
                                       0xff,
                                       0x7fff,
                                       0x8000,
                                       0xffff,
                                       0x10000,
                                       0x7fffffff,
                                       0x80000000,
                                       0xffffffff,
                                       0x100000000,
                                       0x7fffffffffffffff,
                                       0x8000000000000000,
                                       0xffffffffffffffff,
                                       size,
                                       size + 1};
      char raw[8];
      const std::size_t n = std::size_t(1) << below(rng, 4);
      const std::uint64_t value = kValues[below(rng, std::size(kValues))];
      std::memcpy(raw, &value, sizeof raw);
      if (below(rng, 2)) std::reverse(raw, raw + n);
      for (std::size_t i = 0; i < n && at + i < size; ++i) bytes[at + i] = raw[i];
    }
  }
  return bytes;
}

std::string mutated(const std::string& input, Form form, Rng& rng, std::size_t most, const std::vector<std::string>& paths) {
  std::string out;
  if (form == Form::Json)
    out = mutatedJson(input, rng, paths);
  else if (form == Form::Text && (input.find('\0') == std::string::npos || below(rng, 2) == 0))
    out = mutatedText(input, rng, paths);  // also half of the binary meshes, whose header is text
  else
    out = mutatedBytes(input, rng);
  if (form == Form::Bytes)
    for (std::size_t i = 0, n = below(rng, 6); i < n; ++i) out = mutatedBytes(std::move(out), rng);
  if (out.size() > most) out.resize(most);
  return out;
}

}  // namespace glint::fuzz
