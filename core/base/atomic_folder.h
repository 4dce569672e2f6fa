// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <filesystem>
#include <functional>

namespace glint {

/// Writes a whole folder or nothing: `write` fills a temporary one beside it, which is then renamed; when it throws, nothing
/// stays.
/// @throw InputError (file = the folder) when it exists and is not an empty folder, or cannot be made; whatever `write` throws.
void atomicFolder(const std::filesystem::path& folder, const std::function<void(const std::filesystem::path& temporary)>& write);

}  // namespace glint
