// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <filesystem>

namespace glint {

/// The file under `folder` that shares the longest end of its path with `file` ("a/b/c.ply": FOLDER/a/b/c.ply, then
/// FOLDER/b/c.ply, then FOLDER/c.ply); empty = none.
std::filesystem::path sameUnder(const std::filesystem::path& folder, const std::filesystem::path& file);

}  // namespace glint
