// SPDX-License-Identifier: BSD-3-Clause
#include "core/base/safe_text.h"

#include <algorithm>
#include <cstdint>
#include <utility>

#include "core/base/number_text.h"
#include "core/base/sha256.h"

namespace glint {
namespace {

constexpr std::size_t kLongestWord = 160;      // a path of this length still shows its folder and its name
constexpr std::size_t kLongestName = 180;      // file systems allow 255 bytes; an extension and a temporary file's marks follow
constexpr std::size_t kLongestExtension = 16;  // with its dot: a longer one is a part of the name
constexpr std::size_t kHashDigits = 16;        // 64 bits: two ids of one scene never agree by chance
constexpr std::string_view kEllipsis = "…";

bool continues(char c) { return (static_cast<unsigned char>(c) & 0xC0) == 0x80; }

/// The code point at `i` and its length in bytes; length 0 = not UTF-8 (RFC 3629: no surrogates, no longer form than needed).
std::pair<std::uint32_t, std::size_t> codePoint(std::string_view text, std::size_t i) {
  const auto byte = [&](std::size_t k) { return static_cast<std::uint32_t>(static_cast<unsigned char>(text[k])); };
  const std::uint32_t first = byte(i);
  if (first < 0x80) return {first, 1};
  const std::size_t n = first >= 0xF0 ? 4 : first >= 0xE0 ? 3 : 2;
  if (first < 0xC2 || first > 0xF4 || i + n > text.size()) return {0, 0};
  std::uint32_t value = first & (0xFFu >> (n + 1));
  for (std::size_t k = 1; k < n; ++k) {
    if (!continues(text[i + k])) return {0, 0};
    value = value << 6 | (byte(i + k) & 0x3F);
  }
  constexpr std::uint32_t kLeast[] = {0, 0, 0x80, 0x800, 0x10000};
  if (value < kLeast[n] || value > 0x10FFFF || (value >= 0xD800 && value <= 0xDFFF)) return {0, 0};
  return {value, n};
}

/// C0, DEL, C1, and what turns the direction of writing or is a line end of another kind: of messages and of the names of files.
bool isControl(std::uint32_t c) {
  return c < 0x20 || (c >= 0x7F && c < 0xA0) || c == 0x61C || (c >= 0x200E && c <= 0x200F) || (c >= 0x2028 && c <= 0x202E) ||
         (c >= 0x2066 && c <= 0x2069) || c == 0xFEFF;
}

/// The middle taken out, whole characters kept, at most `most` bytes.
std::string shortened(std::string_view text, std::size_t most) {
  if (text.size() <= most) return std::string(text);
  std::size_t head = (most - kEllipsis.size()) / 2, tail = text.size() - (most - kEllipsis.size() - head);
  while (head > 0 && continues(text[head])) --head;
  while (tail < text.size() && continues(text[tail])) ++tail;
  return std::string(text.substr(0, head)).append(kEllipsis).append(text.substr(tail));
}

}  // namespace

std::string withoutControls(std::string_view text) {
  std::string out;
  out.reserve(text.size());
  for (std::size_t i = 0; i < text.size();) {
    const auto [c, length] = codePoint(text, i);
    if (length == 0) {
      out += formatted("\\x%02X", static_cast<unsigned char>(text[i]));
      ++i;
      continue;
    }
    if (isControl(c) && c != '\n' && c != '\t')
      out += formatted(c < 0x100 ? "\\x%02X" : "\\u%04X", c);
    else
      out += text.substr(i, length);
    i += length;
  }
  return out;
}

std::string messageLine(std::string_view given, std::size_t most) {
  std::string text = withoutControls(given);
  while (!text.empty() && (text.back() == '\n' || text.back() == ' ')) text.pop_back();
  for (char& c : text)
    if (c == '\n' || c == '\t') c = ' ';
  std::string line;
  for (std::size_t from = 0; from < text.size();) {
    const std::size_t to = std::min(text.find(' ', from), text.size());
    line += shortened(std::string_view(text).substr(from, to - from), kLongestWord);
    if (to < text.size()) line += ' ';
    from = to + 1;
  }
  return shortened(line, most);
}

std::string fileNameOf(std::string_view id) {
  if (id.empty()) return "%";
  std::string name;
  for (std::size_t i = 0; i < id.size();) {
    const auto [c, known] = codePoint(id, i);
    const std::string_view bytes = id.substr(i, std::max<std::size_t>(1, known));
    const bool dots = c == '.' && (i == 0 || id[i - 1] == '.' || (i + 1 < id.size() && id[i + 1] == '.'));
    if (known == 0 || dots || isControl(c) || c == '/' || c == '\\' || c == '%')
      for (const char byte : bytes) name += formatted("%%%02X", static_cast<unsigned char>(byte));
    else
      name += bytes;
    i += bytes.size();
  }
  if (name.size() <= kLongestName) return name;
  std::size_t cut = kLongestName - kHashDigits - 1;
  while (cut > 0 && continues(name[cut])) --cut;
  Sha256 hash;
  hash.add(id);
  return name.substr(0, cut) + "~" + hash.hex().substr(0, kHashDigits);
}

std::string copyNameOf(const std::filesystem::path& file, int number) {
  const std::string extension = file.extension().string();
  const bool plain = extension.size() <= kLongestExtension && std::all_of(extension.begin(), extension.end(), [](char c) {
                       return c == '.' || (c >= '0' && c <= '9') || (c >= 'a' && c <= 'z') || (c >= 'A' && c <= 'Z');
                     });
  const std::string mark = number > 1 ? "-" + std::to_string(number) : "";
  return plain && extension != "." ? fileNameOf(file.stem().string()) + mark + extension
                                   : fileNameOf(file.filename().string()) + mark;
}

}  // namespace glint
