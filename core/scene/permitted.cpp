// SPDX-License-Identifier: BSD-3-Clause
#include "core/scene/permitted.h"

#include <algorithm>

namespace glint {
namespace fs = std::filesystem;

bool liesIn(const std::vector<fs::path>& folders, const fs::path& path) {
  std::error_code error;
  const fs::path real = fs::weakly_canonical(fs::absolute(path, error), error);
  if (error) return false;
  return std::any_of(folders.begin(), folders.end(), [&](const fs::path& folder) {
    std::error_code unknown;
    fs::path root = fs::weakly_canonical(fs::absolute(folder, unknown), unknown);
    if (unknown) return false;
    if (!root.has_filename()) root = root.parent_path();  // "a/" is "a"
    return std::mismatch(root.begin(), root.end(), real.begin(), real.end()).first == root.end();
  });
}

}  // namespace glint
