// SPDX-License-Identifier: BSD-3-Clause
#include "core/base/base64.h"

#include <openssl/evp.h>

#include "core/base/outcome.h"

namespace glint {

std::string base64(const std::vector<unsigned char>& bytes) {
  constexpr std::size_t kMost = std::size_t(1) << 30;  // what the library counts in is an int
  require(bytes.size() <= kMost, "base64: too long");
  std::string out(4 * ((bytes.size() + 2) / 3) + 1, '\0');  // and a zero, which the library writes
  out.resize(std::size_t(EVP_EncodeBlock(reinterpret_cast<unsigned char*>(out.data()), bytes.data(), int(bytes.size()))));
  return out;
}

}  // namespace glint
