// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <filesystem>
#include <map>
#include <string>
#include <string_view>
#include <vector>

namespace glint {

/// Finds files by names that another system wrote: exactly so; else the only file whose name differs in case, in its Unicode form
/// (fileNameKey) or by backslashes between folders. Lists each folder once, and only if no name matches exactly. Rights
/// are the caller's matter.
class FileFinder {
 public:
  enum class Ending {
    AsNamed,
    AnyImage,  ///< also the only image of another ending: photographs are converted, and some programs write no ending
  };

  /// FOLDER/NAME; empty = none, or several that differ from the name in such a way.
  std::filesystem::path at(const std::filesystem::path& folder, const std::string& name, Ending ending = Ending::AsNamed);
  /// The file under `folder` that shares the longest end of its path with `file` ("a/b/c.ply": FOLDER/a/b/c.ply, then
  /// FOLDER/b/c.ply, then FOLDER/c.ply), exactly; else as `at`. Empty = none.
  std::filesystem::path under(const std::filesystem::path& folder, const std::string& file, Ending ending = Ending::AsNamed);

  /// "8 files have other names ..., the first: 'a.png' is 'a.PNG'": the files found in spite of case, form or ending. "" = none.
  std::string differences() const;

 private:
  struct Folder {
    /// Names by their key; images by the key of their name without ending.
    std::map<std::u32string, std::vector<std::string>> entries, images;
  };
  const Folder& listed(const std::filesystem::path& folder);
  std::filesystem::path similar(const std::filesystem::path& folder, const std::string& name, Ending ending);
  std::string imageLike(const Folder& folder, const std::string& name) const;

  std::map<std::filesystem::path, Folder> folders_;
  int differing_ = 0;
  std::string first_;
};

/// FileFinder().under(folder, file)
std::filesystem::path sameUnder(const std::filesystem::path& folder, const std::filesystem::path& file);

/// The first bytes of a regular file, fewer where it is shorter; "" for one that cannot be read, and for a pipe, which would
/// make the program wait.
std::string firstBytes(const std::filesystem::path& file, std::size_t most);

/// The ending of a file's name with its dot, ASCII letters in lower case.
std::string lowerEnding(const std::filesystem::path& file);

/// With slashes in place of backslashes.
std::string slashed(std::string name);

/// Equal for names of files (UTF-8) that people take for the same: in small letters (Latin, Greek, Cyrillic), each accent as a
/// mark of its own. Systems disagree about both: Windows and macOS find "IMG.PNG" as "img.png", and macOS hands out an accent
/// apart from its letter. Bytes that are no UTF-8 stand for themselves.
std::u32string fileNameKey(std::string_view name);

}  // namespace glint
