// SPDX-License-Identifier: BSD-3-Clause
#include "core/base/output_place.h"

#include <fcntl.h>
#include <sys/stat.h>
#include <unistd.h>

#include <map>
#include <mutex>
#include <utility>

#include "core/base/outcome.h"
#include "core/base/permitted.h"

namespace glint {
namespace fs = std::filesystem;
namespace {

#ifdef O_PATH
constexpr int kOpen = O_PATH | O_DIRECTORY | O_CLOEXEC;  // also a folder that may be written and not read
#else
constexpr int kOpen = O_RDONLY | O_DIRECTORY | O_CLOEXEC;
#endif

/// Which folder it is just now, whatever its path; {0, 0} = no folder. Not kept: some file systems renumber a folder when a file
/// is first written into it.
using Identity = std::pair<dev_t, ino_t>;
Identity identityOf(const OpenFolder& folder) {
  struct stat info {};
  const int fd = folder.descriptor();
  const bool known = fd == AT_FDCWD ? ::stat(folder.path().c_str(), &info) == 0 : ::fstat(fd, &info) == 0;
  return known ? Identity{info.st_dev, info.st_ino} : Identity{};
}

struct Expected {
  fs::path real;
  std::function<bool()> stillAllowed;
};
struct AllExpected {
  std::mutex mutex;
  std::map<fs::path, Expected> byPath;
};
AllExpected& allExpected() {
  static auto* const all = new AllExpected;  // never destroyed: a thread may still write while the program ends
  return *all;
}

fs::path keyOf(const fs::path& path) {
  std::error_code ignored;  // without a current folder a relative path stays one
  fs::path key = fs::absolute(path, ignored);
  if (key.empty()) key = path;
  key = key.lexically_normal();
  return key.has_filename() ? key : key.parent_path();  // "labels/"
}

}  // namespace

OpenFolder::OpenFolder(const fs::path& folder) : OpenFolder(folder, ::open(folder.empty() ? "." : folder.c_str(), kOpen)) {}

OpenFolder::OpenFolder(fs::path path, int descriptor) : path_(std::move(path)) {
  if (descriptor < 0) return;
  descriptor_ = std::shared_ptr<const int>(new int(descriptor), [](const int* fd) {
    ::close(*fd);
    delete fd;
  });
}

std::optional<OpenFolder> OpenFolder::below(const fs::path& name) const {
  const int fd = ::openat(descriptor(), at(name).c_str(), kOpen | O_NOFOLLOW);
  if (fd < 0) return std::nullopt;
  return OpenFolder(path_ / name, fd);
}

int OpenFolder::descriptor() const { return descriptor_ ? *descriptor_ : AT_FDCWD; }

fs::path OpenFolder::at(const fs::path& name) const { return descriptor_ ? name : path_ / name; }

void expectOutput(const fs::path& path, std::function<bool()> stillAllowed) {
  const fs::path key = keyOf(path), real = realPath(key);
  Expected expected{real, std::move(stillAllowed)};
  AllExpected& all = allExpected();
  const std::lock_guard lock(all.mutex);
  all.byPath.insert_or_assign(key, std::move(expected));
}

void requireAsExpected(const fs::path& path, const OpenFolder& folder) {
  AllExpected& all = allExpected();
  std::unique_lock lock(all.mutex);
  const auto found = all.byPath.find(keyOf(path));
  if (found == all.byPath.end()) return;
  const Expected expected = found->second;
  lock.unlock();
  const bool another = identityOf(folder) != identityOf(OpenFolder(expected.real.parent_path()));
  if (another || realPath(keyOf(path)) != expected.real)
    throw InputError(path.string(), "", "leads elsewhere than when the command began: a link was put there; nothing is written");
  if (!expected.stillAllowed())
    throw InputError(path.string(), "", "was put there while the command ran, by somebody else; nothing is overwritten");
}

void forgetExpected(const fs::path& path) {
  AllExpected& all = allExpected();
  const std::lock_guard lock(all.mutex);
  all.byPath.erase(keyOf(path));
}

}  // namespace glint
