// SPDX-License-Identifier: BSD-3-Clause
#include "core/scene/permitted.h"

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

}  // namespace glint
