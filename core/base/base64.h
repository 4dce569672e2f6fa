// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <string>
#include <vector>

namespace glint {

/// RFC 4648, with padding, in one line.
std::string base64(const std::vector<unsigned char>& bytes);

}  // namespace glint
