// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <filesystem>
#include <string>
#include <utility>
#include <vector>

#include "core/base/outcome.h"

namespace glint {

/// A file from others names a file or folder outside of those that it may name. `what()` says the file, the place and the path, but
/// nothing about what lies there. A person may allow it.
class OutsidePath : public InputError {
 public:
  /// @param folder  in which the file lies, or that the folder is
  OutsidePath(const std::string& file, const std::string& place, const std::string& reason, std::filesystem::path folder)
      : InputError(file, place, reason), folder_(std::move(folder)) {}
  /// Absolute; what a person would have to allow.
  const std::filesystem::path& folder() const { return folder_; }

 private:
  std::filesystem::path folder_;
};

/// Whether `path` lies in one of the folders, or is one. Links are followed, so neither `..` nor a link leaves one unseen; what does
/// not exist counts by its nearest folder that does.
bool liesIn(const std::vector<std::filesystem::path>& folders, const std::filesystem::path& path);

/// Absolute, with links followed as far as the path exists; the path itself where that cannot be told.
std::filesystem::path realPath(const std::filesystem::path& path);

}  // namespace glint
