// SPDX-License-Identifier: BSD-3-Clause
#include "core/base/found_file.h"

#include <system_error>
#include <vector>

namespace glint {
namespace fs = std::filesystem;

fs::path sameUnder(const fs::path& folder, const fs::path& file) {
  if (file.empty()) return {};
  const std::vector<fs::path> parts(file.begin(), file.end());
  for (std::size_t from = 0; from < parts.size(); ++from) {
    fs::path candidate = folder;
    for (std::size_t i = from; i < parts.size(); ++i) candidate /= parts[i].relative_path();
    std::error_code ignored;  // what cannot be asked about is not there
    if (fs::is_regular_file(candidate, ignored)) return candidate.lexically_normal();
  }
  return {};
}

}  // namespace glint
