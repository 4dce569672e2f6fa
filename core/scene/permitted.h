// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <filesystem>
#include <string>
#include <vector>

#include "core/base/outcome.h"

namespace glint {

/// A file from others names a file or folder outside of those that it may name. `what()` says the file, the place and the path, but
/// nothing about what lies there. A person may allow it.
class OutsidePath : public InputError {
 public:
  OutsidePath(const std::string& file, const std::string& place, const std::string& reason) : InputError(file, place, reason) {}
};

/// Whether `path` lies in one of the folders, or is one. Links are followed, so neither `..` nor a link leaves one unseen; what does
/// not exist counts by its nearest folder that does.
bool liesIn(const std::vector<std::filesystem::path>& folders, const std::filesystem::path& path);

}  // namespace glint
