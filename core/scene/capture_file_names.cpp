// SPDX-License-Identifier: BSD-3-Clause
#include "core/scene/capture_file_names.h"

#include "core/base/outcome.h"

namespace glint::capture {
namespace fs = std::filesystem;

fs::path FileNames::image(const std::string& name, const std::vector<fs::path>& folders, const std::string& file,
                          const std::string& place) {
  const auto below = [](const std::string& spelt) {  // without what leads out of a folder that a person named
    fs::path path;
    for (const fs::path& part : fs::path(spelt).relative_path())
      if (part != "..") path /= part;
    return path.string();
  };
  for (const fs::path& folder : photographs_) {
    fs::path found = finder_.under(fs::absolute(folder), below(name), FileFinder::Ending::AnyImage);
    if (found.empty()) found = finder_.under(fs::absolute(folder), below(slashed(name)), FileFinder::Ending::AnyImage);
    if (!found.empty()) return found;
  }
  const fs::path own = in(folders, name, FileFinder::Ending::AnyImage, file, place);
  std::error_code ignored;  // unreadable counts as missing
  const fs::path copy = fs::is_regular_file(own, ignored) ? fs::path() : smallerCopy(own, file, place);
  return copy.empty() ? own : copy;
}

/// Empty = none.
fs::path FileNames::smallerCopy(const fs::path& missing, const std::string& file, const std::string& place) {
  std::error_code ignored;  // as above
  fs::path gone;            // the outermost folder without anything in it
  for (fs::path p = missing.parent_path(); !fs::is_directory(p, ignored) || fs::is_empty(p, ignored); p = p.parent_path())
    gone = p;
  if (gone.empty()) return {};
  for (const char* fold : {"_2", "_4", "_8"}) {
    const std::string smaller = gone.filename().string() + fold;
    const fs::path found =
        finder_.at(gone.parent_path() / smaller, missing.lexically_relative(gone).string(), FileFinder::Ending::AnyImage);
    if (found.empty()) continue;
    smaller_ = "the photographs are those of the folder " + smaller + ": " + gone.filename().string() + " has no such files";
    return resolveInside(gone.parent_path(), found.lexically_relative(gone.parent_path()).string(), rights_, file, place);
  }
  return {};
}

fs::path FileNames::other(const fs::path& folder, const std::string& name, const std::string& file, const std::string& place) {
  return in({folder}, name, FileFinder::Ending::AsNamed, file, place);
}

fs::path FileNames::in(const std::vector<fs::path>& folders, const std::string& name, FileFinder::Ending ending,
                       const std::string& file, const std::string& place) {
  require(!folders.empty(), "FileNames: no folder");
  std::error_code ignored;  // unreadable counts as missing
  const auto isFile = [&](const fs::path& p) { return fs::is_regular_file(p, ignored); };
  const fs::path first = resolveInside(folders.front(), name, rights_, file, place);
  if (isFile(first)) return first;
  for (std::size_t i = 1; i < folders.size(); ++i)
    if (const fs::path p = resolveInside(folders[i], name, rights_, file, place); isFile(p)) return p;
  const std::string plain = slashed(name);
  const bool isOther = plain != name;
  const fs::path missing = isOther ? resolveInside(folders.front(), plain, rights_, file, place) : first;
  for (const fs::path& folder : folders) {
    if (isOther) resolveInside(folder, plain, rights_, file, place);  // before anything is looked up there
    const fs::path found = finder_.at(folder, plain, ending);
    if (!found.empty()) return resolveInside(folder, found.lexically_relative(folder).string(), rights_, file, place);
  }
  return missing;
}

void FileNames::tell(std::vector<std::string>& warnings) const {
  if (const std::string line = finder_.differences(); !line.empty()) warnings.push_back(line);
  if (!smaller_.empty()) warnings.push_back(smaller_);
}

}  // namespace glint::capture
