// SPDX-License-Identifier: BSD-3-Clause
#pragma once

// Internal to io: numbers of a given byte order. The caller has checked that the bytes are there.

#include <bit>
#include <cstring>
#include <type_traits>

namespace glint::io {

template <class T>
T valueAt(const char* at, bool bigEndian) {
  static_assert(std::endian::native == std::endian::little || std::endian::native == std::endian::big);
  char bytes[sizeof(T)];
  const bool turn = bigEndian != (std::endian::native == std::endian::big);
  for (std::size_t i = 0; i < sizeof(T); ++i) bytes[i] = at[turn ? sizeof(T) - 1 - i : i];
  T value;
  std::memcpy(&value, bytes, sizeof(T));
  return value;
}

/// What may follow the last element of a binary file: padding.
inline bool isPadding(char c) { return c == '\0' || c == '\n' || c == '\r' || c == ' '; }

}  // namespace glint::io
