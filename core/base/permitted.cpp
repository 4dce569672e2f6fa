// SPDX-License-Identifier: BSD-3-Clause
#include "core/base/permitted.h"

#include <algorithm>

namespace glint {
namespace fs = std::filesystem;

bool liesIn(const std::vector<fs::path>& folders, const fs::path& path) {
  std::error_code error;
  const fs::path real = fs::weakly_canonical(fs::absolute(path, error), error);  // not realPath: what cannot be told lies nowhere
  if (error) return false;
  return std::any_of(folders.begin(), folders.end(), [&](const fs::path& folder) {
    std::error_code unknown;
    fs::path root = fs::weakly_canonical(fs::absolute(folder, unknown), unknown);
    if (unknown) return false;
    if (!root.has_filename()) root = root.parent_path();  // "a/" is "a"
    return std::mismatch(root.begin(), root.end(), real.begin(), real.end()).first == root.end();
  });
}

fs::path realPath(const fs::path& path) {
  std::error_code error;
  const fs::path absolute = fs::absolute(path, error);
  if (error) return path;
  fs::path real = fs::weakly_canonical(absolute, error);
  if (error) return absolute.lexically_normal();
  return real.has_filename() ? real : real.parent_path();  // "a/" is "a"
}

fs::path resolveInside(const fs::path& folder, const std::string& relative, const PathRights& rights, const std::string& file,
                       const std::string& place) {
  if (relative.empty()) throw InputError(file, place, "the path is empty");
  if (relative.find('\0') != std::string::npos) throw InputError(file, place, "the path contains a zero byte");
  const fs::path path(relative);
  const fs::path absolute = (path.is_absolute() ? path : folder / path).lexically_normal();
  if (rights.anywhere || liesIn(rights.folders, absolute)) return absolute;
  if (path.is_absolute())
    throw OutsidePath(file, place,
                      "'" + relative + "' is absolute; paths must be relative to the file (--allow-outside accepts it)",
                      realPath(absolute).parent_path());
  if (!liesIn({folder}, folder / path))
    throw OutsidePath(file, place, "'" + relative + "' leaves the folder of the file (--allow-outside accepts it)",
                      realPath(absolute).parent_path());
  return absolute;
}

}  // namespace glint
