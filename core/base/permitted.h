// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <filesystem>
#include <string>
#include <utility>
#include <vector>

#include "core/base/outcome.h"

namespace glint {

/// A file from others names a file or folder outside of those that it may name. `what()` says the file, the place and the path,
/// but nothing about what lies there. A person may allow it.
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

/// Whether `path` lies in one of the folders, or is one. Links are followed, so neither `..` nor a link leaves one unseen; what
/// does not exist counts by its nearest folder that does.
bool liesIn(const std::vector<std::filesystem::path>& folders, const std::filesystem::path& path);

/// Absolute, with links followed as far as the path exists; the path itself where that cannot be told.
std::filesystem::path realPath(const std::filesystem::path& path);

/// Which files a file from others may name besides those in its own folder.
struct PathRights {
  bool anywhere = false;                            ///< --allow-outside
  std::vector<std::filesystem::path> folders = {};  ///< those that a person named
};

/// The file that `place` of a document in `folder` names. `relative` is taken relative to the folder; the result is absolute
/// and lexically normal, and may not exist.
/// @throw InputError (file, place) if it is empty; OutsidePath if it is absolute or leaves the folder (by `..` or through a
///        symbolic link), unless it lies in one of `rights.folders` or `rights.anywhere` is true.
std::filesystem::path resolveInside(const std::filesystem::path& folder, const std::string& relative, const PathRights& rights,
                                    const std::string& file, const std::string& place);

}  // namespace glint
