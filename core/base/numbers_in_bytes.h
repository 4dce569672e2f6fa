// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cstdint>
#include <optional>
#include <string_view>

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

}  // namespace glint
