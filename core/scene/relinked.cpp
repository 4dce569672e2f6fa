// SPDX-License-Identifier: BSD-3-Clause
#include "core/scene/relinked.h"

#include <system_error>
#include <utility>

namespace glint {
namespace fs = std::filesystem;

MissingMesh::MissingMesh(const std::string& file, const std::string& place, std::string named, fs::path mesh)
    : InputError(file, place, "file '" + mesh.string() + "' does not exist"), named_(std::move(named)), mesh_(std::move(mesh)) {}

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
