// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <filesystem>
#include <vector>

namespace glint {

/// Whether `synth` may write these files into `folder`: none of them exists, or an earlier run of it made the folder. It is told by
/// the folder's scene.json: a glint_scene whose frames name no files, or exactly those that `synth` writes under its names.
/// @param names  relative to the folder
/// @throw InputError (the file that exists)
void requireSynthFolder(const std::filesystem::path& folder, const std::vector<std::filesystem::path>& names);

}  // namespace glint
