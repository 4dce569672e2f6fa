// SPDX-License-Identifier: BSD-3-Clause
#include "core/base/temporary_path.h"

#include <fcntl.h>
#include <sys/file.h>
#include <sys/stat.h>
#include <unistd.h>

#include <algorithm>
#include <atomic>
#include <cerrno>
#include <chrono>
#include <cstring>
#include <mutex>
#include <set>
#include <string>
#include <string_view>
#include <thread>
#include <utility>

#include "core/base/atomic_file.h"
#include "core/base/outcome.h"
#include "core/base/progress.h"

namespace glint {
namespace fs = std::filesystem;

namespace {

constexpr std::string_view kMark = ".glint-", kEnd = ".tmp";

/// State of all threads: what is under way, where this process has cleaned up, whether it ends.
struct Registry {
  std::timed_mutex mutex;
  std::set<fs::path> unfinished, cleaned;
  std::atomic<bool> ending{false};
};
Registry& registry() {
  static auto* const all = new Registry;  // never destroyed: a thread may still write while the program ends
  return *all;
}

std::string nextName(const fs::path& target) {
  static std::atomic<unsigned> counter{0};
  constexpr std::size_t kStem = 100;  // a name has at most 255 bytes, and the rest of this one needs its share
  std::string name = ".";
  name.append(target.stem().string().substr(0, kStem)).append(kMark).append(std::to_string(::getpid())).append("-");
  return name.append(std::to_string(counter++)).append(kEnd).append(target.extension().string());
}

/// Whether `nextName` gives such names.
bool isOurs(const std::string& name) {
  const std::size_t mark = name.rfind(kMark);
  if (name.empty() || name[0] != '.' || mark == std::string::npos) return false;
  std::size_t at = mark + kMark.size();
  const auto digits = [&] {
    const std::size_t start = at;
    while (at < name.size() && name[at] >= '0' && name[at] <= '9') ++at;
    return at > start;
  };
  if (!digits() || at >= name.size() || name[at++] != '-' || !digits() || name.compare(at, kEnd.size(), kEnd) != 0) return false;
  at += kEnd.size();
  return at == name.size() || (name[at] == '.' && name.find('.', at + 1) == std::string::npos);
}

bool sameFile(const struct stat& a, const struct stat& b) { return a.st_dev == b.st_dev && a.st_ino == b.st_ino; }

void removeIfAbandoned(const fs::path& path) {
  struct stat named {
  }, opened{};
  if (::lstat(path.c_str(), &named) != 0 || named.st_uid != ::geteuid()) return;
  if (!S_ISREG(named.st_mode) && !S_ISDIR(named.st_mode)) return;
  const int fd = ::open(path.c_str(), O_RDONLY | O_CLOEXEC | O_NOFOLLOW | O_NONBLOCK);
  if (fd < 0) return;
  if (::fstat(fd, &opened) == 0 && sameFile(named, opened) && ::flock(fd, LOCK_EX | LOCK_NB) == 0) {
    std::error_code ignored;  // the next one may succeed
    fs::remove_all(path, ignored);
  }
  ::close(fd);
}

void cleanOnce(const fs::path& folder) {
  {
    Registry& all = registry();
    const std::lock_guard<std::timed_mutex> lock(all.mutex);
    if (!all.cleaned.insert(folder).second) return;
  }
  removeAbandonedTemporaries(folder);
}

/// Removes a file or folder that threads may still write to; false if it has more files than `most`, which `files` counts.
bool removeAside(const fs::path& path, int most, int& files) {
  std::error_code ignored;
  fs::path at = path;
  if (fs::is_directory(path, ignored)) {
    // Under another name of ours first: threads that make more files in it find no folder, so that it can be emptied.
    const fs::path aside = path.parent_path() / nextName(path);
    if (::rename(path.c_str(), aside.c_str()) == 0) at = aside;
    std::error_code error;
    for (fs::recursive_directory_iterator it(at, error), end; !error && it != end; it.increment(error)) {
      if (++files > most) return false;
      if (!it->is_directory(ignored)) ::unlink(it->path().c_str());
    }
  }
  fs::remove_all(at, ignored);
  return true;
}

}  // namespace

void removeAbandonedTemporaries(const fs::path& folder) {
  std::error_code error;
  std::set<fs::path> found;
  for (fs::directory_iterator it(folder.empty() ? "." : folder, error), end; !error && it != end; it.increment(error))
    if (isOurs(it->path().filename().string())) found.insert(it->path());
  for (const fs::path& path : found) removeIfAbandoned(path);
}

TemporaryPath::TemporaryPath(OpenFolder folder, const fs::path& target, Kind kind) : folder_(std::move(folder)) {
  cleanOnce(folder_.path());
  constexpr int kTries = 100;  // another machine's process of this number may have taken a name
  for (int i = 0; i < kTries && descriptor_ < 0; ++i) {
    path_ = folder_.path() / nextName(target);
    const int at = folder_.descriptor();
    const fs::path here = folder_.at(name());
    Registry& all = registry();
    {
      // Before it is there: the lock is not held while the system makes it, which may take any time.
      const std::lock_guard<std::timed_mutex> lock(all.mutex);
      if (all.ending) throw Stopped{};
      all.unfinished.insert(path_);
    }
    if (kind == Kind::File)
      descriptor_ = ::openat(at, here.c_str(), O_RDWR | O_CREAT | O_EXCL | O_CLOEXEC, 0666);
    else if (::mkdirat(at, here.c_str(), 0777) == 0)
      descriptor_ = ::openat(at, here.c_str(), O_RDONLY | O_DIRECTORY | O_NOFOLLOW | O_CLOEXEC);
    if (descriptor_ >= 0 && all.ending) {
      std::error_code ignored;  // the next program removes it
      fs::remove_all(path_, ignored);
      ::close(descriptor_);
      throw Stopped{};
    }
    if (descriptor_ < 0) {
      const int error = errno;
      {
        const std::lock_guard<std::timed_mutex> lock(all.mutex);
        all.unfinished.erase(path_);
      }
      if (error == EEXIST) continue;
      if (kind == Kind::Folder) ::rmdir(path_.c_str());
      throw InputError(target.string(), "", std::string("cannot be written: ") + std::strerror(error));
    }
    // Between its making and its lock another program may have taken it for one that was left. A file system without locks
    // refuses them to others too.
    struct stat now {};
    const bool taken = ::flock(descriptor_, LOCK_EX | LOCK_NB) != 0 && errno == EWOULDBLOCK;
    if (taken || ::fstat(descriptor_, &now) != 0 || now.st_nlink == 0) {
      ::close(descriptor_);
      descriptor_ = -1;
    }
  }
  if (descriptor_ < 0) throw InputError(target.string(), "", "cannot be written: no free name for a temporary file");
}

bool TemporaryPath::moveTo(const fs::path& target) {
  const int at = folder_.descriptor();
  moved_ = ::renameat(at, folder_.at(name()).c_str(), at, folder_.at(target).c_str()) == 0;
  return moved_;
}

TemporaryPath::~TemporaryPath() {
  std::error_code ignored;  // the next program removes what cannot be removed now
  if (!moved_) fs::remove_all(path_, ignored);
  if (descriptor_ >= 0) ::close(descriptor_);
  Registry& all = registry();
  const std::lock_guard<std::timed_mutex> lock(all.mutex);
  all.unfinished.erase(path_);
}

void removeUnfinishedWrites() {
  // Folders may be large, and the program promises to end soon: beyond so many files the next program removes the rest.
  constexpr int kMostFiles = 1000;
  constexpr std::chrono::milliseconds kLongestWait(20), kPause(5);
  constexpr int kPasses = 3;
  int files = 0;
  Registry& all = registry();
  all.ending = true;
  for (int pass = 0; pass < kPasses; ++pass) {
    // A thread that holds it may be stuck in the system: on a network drive that does not answer.
    std::unique_lock<std::timed_mutex> lock(all.mutex, kLongestWait);
    if (!lock) return;
    const std::set<fs::path> paths = all.unfinished;
    lock.unlock();
    if (paths.empty()) return;
    for (const fs::path& path : paths)
      if (!removeAside(path, kMostFiles, files)) return;
    // A thread that was just making one of them goes on, sees that the program ends, and makes no other.
    std::this_thread::sleep_for(kPause);
    std::error_code ignored;
    if (std::none_of(paths.begin(), paths.end(),
                     [&](const fs::path& path) { return fs::exists(fs::symlink_status(path, ignored)); }))
      return;
  }
}

}  // namespace glint
