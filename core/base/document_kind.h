// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <filesystem>
#include <string>

namespace glint {

/// What a JSON file is, by the key at its top that names its format: "glint_scene", "glint_session", "glint_evaluation" and so
/// on. "" if the file is missing, is no regular file, cannot be read or parsed, or has no such key. Never throws.
std::string documentKind(const std::filesystem::path& file);

}  // namespace glint
