// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <filesystem>

#include "core/base/output_place.h"

namespace glint {

/// A hidden file or folder for a write that is under way: ".NAME.glint-PROCESS-NUMBER.tmp.EXTENSION". It is locked (flock) while
/// its writer lives, so that others can tell it from one that a killed program left. The destructor removes it unless it was
/// moved into place.
class TemporaryPath {
 public:
  enum class Kind { File, Folder };
  /// Makes it, empty. Before a process makes its first one in a folder, it removes there what killed programs left.
  /// @param folder  where it lies; on the file system of the target, because a rename works on one only
  /// @param target  gives name and extension (encoders look at the extension), and is named in errors
  /// @throw InputError (file = the target); Stopped while the program ends (`removeUnfinishedWrites`)
  TemporaryPath(OpenFolder folder, const std::filesystem::path& target, Kind kind);
  TemporaryPath(const std::filesystem::path& folder, const std::filesystem::path& target, Kind kind)
      : TemporaryPath(OpenFolder(folder), target, kind) {}
  ~TemporaryPath();
  TemporaryPath(const TemporaryPath&) = delete;
  TemporaryPath& operator=(const TemporaryPath&) = delete;

  const std::filesystem::path& path() const { return path_; }
  int descriptor() const { return descriptor_; }        ///< of a file: open for writing
  const OpenFolder& folder() const { return folder_; }  ///< in which it lies
  std::filesystem::path name() const { return path_.filename(); }
  /// One rename in its folder, over what is there; a link is replaced, not followed. False with errno when it is refused.
  bool moveTo(const std::filesystem::path& name);

 private:
  OpenFolder folder_;
  std::filesystem::path path_;
  int descriptor_ = -1;
  bool moved_ = false;
};

/// Removes the files and folders in `folder` that a TemporaryPath of a program made that runs no more. What is locked, belongs to
/// another user or has another name stays. Never fails.
void removeAbandonedTemporaries(const std::filesystem::path& folder);

}  // namespace glint
