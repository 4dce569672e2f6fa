// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <string>

namespace glint::testing_support {

/// As many bytes of a PNG as say its size: signature, header chunk and end chunk (PNG specification, third edition, 5 and 11.2).
inline std::string pngOfSize(unsigned width, unsigned height) {
  std::string png("\x89PNG\r\n\x1a\n\0\0\0\rIHDR", 16);
  for (const unsigned n : {width, height})
    for (const unsigned shift : {24u, 16u, 8u, 0u}) png += static_cast<char>(n >> shift & 0xffu);
  png += std::string("\x08\x02\0\0\0", 5) + std::string(4, '\0');  // 8 bits, colour; checksum
  return png + std::string("\0\0\0\0IEND", 8) + std::string(4, '\0');
}

}  // namespace glint::testing_support
