// SPDX-License-Identifier: BSD-3-Clause
#pragma once

// Numbers in bytes, and bytes as text.
#include <cstdint>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

namespace glint {

/// Unsigned numbers at places of a file of one byte order. The bytes must outlive it.
class NumbersInBytes {
 public:
  NumbersInBytes(std::string_view bytes, bool bigEndian) : bytes_(bytes), big_(bigEndian) {}
  /// The number in `size` bytes, 1 to 8, from byte `at` on; nothing if the file ends before.
  std::optional<std::uint64_t> number(std::uint64_t at, unsigned size) const {
    if (at > bytes_.size() || bytes_.size() - at < size) return std::nullopt;
    std::uint64_t v = 0;
    for (unsigned i = 0; i < size; ++i)
      v = v << 8 | static_cast<unsigned char>(bytes_[static_cast<std::size_t>(at) + (big_ ? i : size - 1 - i)]);
    return v;
  }
  std::uint64_t size() const { return bytes_.size(); }

 private:
  std::string_view bytes_;
  bool big_;
};

/// RFC 4648, with padding, in one line.
std::string base64(const std::vector<unsigned char>& bytes);

/// The bytes that such a text encodes, with its padding or without; nothing if the text is not base64.
std::optional<std::string> fromBase64(std::string_view text);

}  // namespace glint
