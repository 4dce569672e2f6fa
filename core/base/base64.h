// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <optional>
#include <string>
#include <string_view>
#include <vector>

namespace glint {

/// RFC 4648, with padding, in one line.
std::string base64(const std::vector<unsigned char>& bytes);

/// The bytes that such a text encodes, with its padding or without; nothing if the text is not base64.
std::optional<std::string> fromBase64(std::string_view text);

}  // namespace glint
