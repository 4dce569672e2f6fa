// SPDX-License-Identifier: BSD-3-Clause
#include "core/base/bytes.h"

#include <openssl/evp.h>

#include <array>
#include <cstdint>

#include "core/base/outcome.h"

namespace glint {

std::string base64(const std::vector<unsigned char>& bytes) {
  constexpr std::size_t kMost = std::size_t(1) << 30;  // what the library counts in is an int
  require(bytes.size() <= kMost, "base64: too long");
  std::string out(4 * ((bytes.size() + 2) / 3) + 1, '\0');  // and a zero, which the library writes
  out.resize(std::size_t(EVP_EncodeBlock(reinterpret_cast<unsigned char*>(out.data()), bytes.data(), int(bytes.size()))));
  return out;
}

// Our own: the library's passes over blanks, counts in an int, and leaves zeros where the padding was.
std::optional<std::string> fromBase64(std::string_view text) {
  static const std::array<std::int8_t, 256> kValues = [] {
    std::array<std::int8_t, 256> values;
    values.fill(-1);
    constexpr std::string_view kDigits = "ABCDEFGHIJKLMNOPQRSTUVWXYZabcdefghijklmnopqrstuvwxyz0123456789+/";
    for (std::size_t i = 0; i < kDigits.size(); ++i) values[static_cast<unsigned char>(kDigits[i])] = static_cast<std::int8_t>(i);
    return values;
  }();
  if (text.size() % 4 == 0 && text.ends_with('=')) text.remove_suffix(text.ends_with("==") ? 2 : 1);
  if (text.size() % 4 == 1) return std::nullopt;  // six bits are no byte
  std::string out;
  out.reserve(text.size() / 4 * 3 + 2);
  std::uint32_t bits = 0;
  int known = 0;  // of `bits`, the lowest
  for (const char c : text) {
    const std::int8_t value = kValues[static_cast<unsigned char>(c)];
    if (value < 0) return std::nullopt;
    bits = bits << 6 | std::uint32_t(value);
    known += 6;
    if (known < 8) continue;
    known -= 8;
    out.push_back(static_cast<char>(bits >> known & 0xff));
  }
  return out;
}

}  // namespace glint
