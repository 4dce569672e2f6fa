// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <filesystem>
#include <string>
#include <vector>

#include "core/base/found_file.h"
#include "core/base/permitted.h"

namespace glint::capture {

/// Where the files are that a capture or a scene names: the one place for slashes, case, Unicode form and ending (FileFinder),
/// for `--photographs`, and for what a file from others may name. One for each reading: it knows the folders that it has listed.
class FileNames {
 public:
  /// @param photographs  folders in which images are looked for first
  explicit FileNames(PathRights rights, std::vector<std::filesystem::path> photographs = {})
      : rights_(std::move(rights)), photographs_(std::move(photographs)) {}

  /// Where the image of this name is: in the first of `photographs` that holds it (by the longest end of its path), else in the
  /// first of `folders` that does, else a smaller copy of other programs (images_2, images_4, images_8 beside a folder images
  /// that is missing or empty), else in the first of `folders`, where it is missing. OutsidePath if the name leaves that folder.
  std::filesystem::path image(const std::string& name, const std::vector<std::filesystem::path>& folders, const std::string& file,
                              const std::string& place);
  /// Another file (depth, mask, mesh), whose ending says what it is. It may be missing. OutsidePath as above.
  std::filesystem::path other(const std::filesystem::path& folder, const std::string& name, const std::string& file,
                              const std::string& place);
  /// Adds a line about the names that differ from the files', and one about smaller copies, where there are any.
  void tell(std::vector<std::string>& warnings) const;

 private:
  std::filesystem::path smallerCopy(const std::filesystem::path& missing, const std::string& file, const std::string& place);
  std::filesystem::path in(const std::vector<std::filesystem::path>& folders, const std::string& name, FileFinder::Ending ending,
                           const std::string& file, const std::string& place);

  PathRights rights_;
  std::vector<std::filesystem::path> photographs_;
  FileFinder finder_;
  std::string smaller_;  ///< what tell() says of smaller copies
};

}  // namespace glint::capture
