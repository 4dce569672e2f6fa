// SPDX-License-Identifier: BSD-3-Clause
#pragma once

// Internal to io: how a binary STL is laid out. 80 bytes of comment, a count, then 50 bytes a facet: normal, three corners (12
// floats) and two bytes that programs use as they like. Little endian.

#include <cstdint>
#include <string_view>

namespace glint::io {

constexpr std::size_t kStlHead = 84, kStlCountAt = 80, kStlFacet = 50, kStlNormal = 12;

/// Size of the file by its own count; 0 when it has none.
inline std::size_t stlBytesPromised(std::string_view bytes) {
  if (bytes.size() < kStlHead) return 0;
  std::uint32_t facets = 0;
  for (std::size_t i = 0; i < 4; ++i) facets |= std::uint32_t(static_cast<unsigned char>(bytes[kStlCountAt + i])) << (8 * i);
  return kStlHead + kStlFacet * std::size_t(facets);
}

/// The first word is "solid", in any case and behind any blanks: a text, unless the size is that of a binary file.
bool beginsAsStlText(std::string_view bytes);

}  // namespace glint::io
