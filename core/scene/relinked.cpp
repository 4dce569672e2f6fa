// SPDX-License-Identifier: BSD-3-Clause
#include "core/scene/relinked.h"

#include <system_error>
#include <utility>

namespace glint {
namespace fs = std::filesystem;

MissingMesh::MissingMesh(const std::string& file, const std::string& place, std::string named, fs::path mesh)
    : InputError(file, place, "file '" + mesh.string() + "' does not exist"), named_(std::move(named)), mesh_(std::move(mesh)) {}

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

fs::path folderOfMove(const fs::path& file, const fs::path& now) {
  fs::path was = file.lexically_normal(), is = now.lexically_normal();
  if (was.filename() != is.filename()) return is.parent_path();
  while (was.has_filename() && was.filename() == is.filename() && is.has_relative_path()) {
    was = was.parent_path();
    is = is.parent_path();
  }
  return is;
}

}  // namespace glint
