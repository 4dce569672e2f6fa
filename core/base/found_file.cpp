// SPDX-License-Identifier: BSD-3-Clause
#include "core/base/found_file.h"

#include <algorithm>
#include <array>
#include <fstream>
#include <system_error>

namespace glint {
namespace fs = std::filesystem;
namespace {

/// A name without ending takes them in this order, which is that of nerfstudio and of the original NeRF data.
constexpr std::array<const char*, 10> kImageEndings{".png", ".jpg", ".jpeg", ".tif", ".tiff",
                                                    ".exr", ".bmp", ".webp", ".hdr", ".ppm"};

std::size_t endingNumber(const fs::path& name) {
  return std::size_t(std::find(kImageEndings.begin(), kImageEndings.end(), lowerEnding(name)) - kImageEndings.begin());
}
bool isImageName(const fs::path& name) { return endingNumber(name) < kImageEndings.size(); }

bool isFile(const fs::path& path) {
  std::error_code ignored;  // unreadable counts as missing
  return fs::is_regular_file(path, ignored);
}

}  // namespace

std::string slashed(std::string name) {
  std::replace(name.begin(), name.end(), '\\', '/');
  return name;
}

const FileFinder::Folder& FileFinder::listed(const fs::path& folder) {
  const auto [known, isNew] = folders_.try_emplace(folder);
  Folder& list = known->second;
  if (!isNew) return list;
  std::error_code error;  // what cannot be listed holds nothing
  for (fs::directory_iterator it(folder, error), end; !error && it != end; it.increment(error)) {
    const fs::path name = it->path().filename();
    list.entries[fileNameKey(name.string())].push_back(name.string());
    if (isImageName(name)) list.images[fileNameKey(name.stem().string())].push_back(name.string());
  }
  return list;
}

/// "" = none, or several.
std::string FileFinder::imageLike(const Folder& folder, const std::string& name) const {
  const bool hasEnding = isImageName(name);
  const auto found = folder.images.find(fileNameKey(hasEnding ? fs::path(name).stem().string() : name));
  if (found == folder.images.end() || (hasEnding && found->second.size() > 1)) return "";
  return *std::min_element(found->second.begin(), found->second.end(), [](const auto& a, const auto& b) {
    return std::make_pair(endingNumber(a), a) < std::make_pair(endingNumber(b), b);
  });
}

/// `name` with slashes only. Folder by folder, so that each of them may differ.
fs::path FileFinder::similar(const fs::path& folder, const std::string& name, Ending ending) {
  const fs::path parts = fs::path(name).relative_path().lexically_normal();
  fs::path place = folder;
  std::error_code ignored;  // unreadable counts as missing
  for (auto part = parts.begin(); part != parts.end(); ++part) {
    const bool last = std::next(part) == parts.end();
    const std::string text = part->string();
    std::string now;
    if (text == ".." || (last ? isFile(place / *part) : fs::is_directory(place / *part, ignored))) {
      now = text;
    } else {
      const Folder& list = listed(place);
      const auto found = list.entries.find(fileNameKey(text));
      if (found != list.entries.end() && found->second.size() == 1) now = found->second.front();
      if (now.empty() && found == list.entries.end() && last && ending == Ending::AnyImage) now = imageLike(list, text);
    }
    if (now.empty()) return {};
    place /= now;
  }
  return isFile(place) ? place.lexically_normal() : fs::path();
}

fs::path FileFinder::at(const fs::path& folder, const std::string& name, Ending ending) {
  if (name.empty()) return {};
  if (fs::path exact = folder / name; isFile(exact)) return exact.lexically_normal();
  const std::string plain = slashed(name);
  fs::path found = similar(folder, plain, ending);
  if (found.empty()) return {};
  const fs::path expected = (folder / fs::path(plain).relative_path()).lexically_normal();
  const bool onlyEnding =
      !isImageName(expected) && found.parent_path() == expected.parent_path() && found.stem() == expected.filename();
  if (found != expected && !onlyEnding && differing_++ == 0)
    first_ = "'" + plain + "' is '" + found.lexically_relative(folder).generic_string() + "'";
  return found;
}

fs::path FileFinder::under(const fs::path& folder, const std::string& file, Ending ending) {
  if (file.empty()) return {};
  const auto search = [&](const fs::path& path, const auto& take) -> fs::path {
    const std::vector<fs::path> parts(path.begin(), path.end());
    for (std::size_t from = 0; from < parts.size(); ++from) {
      fs::path end;
      for (std::size_t i = from; i < parts.size(); ++i) end /= parts[i].relative_path();
      if (end.empty()) continue;
      if (fs::path found = take(end); !found.empty()) return found;
    }
    return {};
  };
  fs::path exact =
      search(file, [&](const fs::path& end) { return isFile(folder / end) ? (folder / end).lexically_normal() : fs::path(); });
  if (!exact.empty()) return exact;
  return search(slashed(file), [&](const fs::path& end) { return at(folder, end.string(), ending); });
}

std::string FileFinder::differences() const {
  if (differing_ == 0) return "";
  if (differing_ == 1) return "1 file has another name than is written, in case, Unicode form or ending: " + first_;
  return std::to_string(differing_) +
         " files have other names than are written, in case, Unicode form or ending; the first: " + first_;
}

fs::path sameUnder(const fs::path& folder, const fs::path& file) { return FileFinder().under(folder, file.string()); }

std::string lowerEnding(const fs::path& file) {
  std::string ending = file.extension().string();
  for (char& c : ending)
    if (c >= 'A' && c <= 'Z') c = static_cast<char>(c - 'A' + 'a');
  return ending;
}

std::string firstBytes(const fs::path& file, std::size_t most) {
  std::error_code error;
  if (!fs::is_regular_file(file, error)) return "";
  std::ifstream in(file, std::ios::binary);
  std::string bytes(most, '\0');
  in.read(bytes.data(), static_cast<std::streamsize>(most));
  bytes.resize(static_cast<std::size_t>(std::max<std::streamsize>(0, in.gcount())));
  return bytes;
}

}  // namespace glint
