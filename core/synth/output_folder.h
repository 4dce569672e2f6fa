// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <filesystem>
#include <vector>

namespace glint {

/// Whether `synth` may write these files into `folder`: none of them exists, or an earlier run of it made the folder, which the
/// folder's scene.json says ("made_by"). The names of files are no sign of it: anyone may name highlights and files as `synth`
/// does. The write checks again (expectOutput).
/// @param names  relative to the folder
/// @throw InputError (the file that exists)
void requireSynthFolder(const std::filesystem::path& folder, const std::vector<std::filesystem::path>& names);

}  // namespace glint
