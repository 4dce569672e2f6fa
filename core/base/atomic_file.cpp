// SPDX-License-Identifier: BSD-3-Clause
#include "core/base/atomic_file.h"

#include <fcntl.h>
#include <sys/stat.h>
#include <unistd.h>

#include <cerrno>
#include <cstring>

#include "core/base/outcome.h"
#include "core/base/temporary_path.h"

namespace glint {
namespace fs = std::filesystem;

namespace {

InputError systemError(const fs::path& file, const char* what, int error) {
  return InputError(file.string(), "", std::string(what) + ": " + std::strerror(error));
}

/// Owns a file descriptor; errors of close() matter when writing, so the owner closes it by hand on success.
struct Descriptor {
  int fd = -1;
  ~Descriptor() {
    if (fd >= 0) ::close(fd);
  }
  int release() {
    const int f = fd;
    fd = -1;
    return f;
  }
};

void writeAll(int fd, std::string_view content, const fs::path& file) {
  while (!content.empty()) {
    const ssize_t n = ::write(fd, content.data(), content.size());
    if (n < 0 && errno == EINTR) continue;
    if (n <= 0) throw systemError(file, "cannot be written", n < 0 ? errno : ENOSPC);
    content.remove_prefix(static_cast<std::size_t>(n));
  }
}

void checkTarget(const fs::path& file) {
  if (file.empty() || !file.has_filename()) throw InputError(file.string(), "", "is not a file name");
  std::error_code error;
  const fs::path folder = file.has_parent_path() ? file.parent_path() : fs::path(".");
  if (!fs::is_directory(folder, error))
    throw InputError(file.string(), "", "cannot be written: the folder " + folder.string() + " does not exist");
  if (fs::is_directory(file, error)) throw InputError(file.string(), "", "cannot be written: it is a folder");
  // A rename would replace it all the same; a read-only file is meant to stay.
  if (::access(file.c_str(), F_OK) == 0 && ::access(file.c_str(), W_OK) != 0) throw systemError(file, "cannot be written", errno);
}

void flushAndMove(TemporaryPath& temporary, const fs::path& file, const fs::path& requested) {
  const OpenFolder& folder = temporary.folder();
  // Opened anew: an encoder may have replaced the file that was made.
  Descriptor d{::openat(folder.descriptor(), folder.at(temporary.name()).c_str(), O_RDONLY | O_CLOEXEC | O_NOFOLLOW)};
  if (d.fd < 0) throw systemError(requested, "cannot be written", errno);
  if (::fsync(d.fd) != 0) throw systemError(requested, "cannot be written", errno);
  // A file that already exists keeps its permissions.
  struct stat old {};
  if (::fstatat(folder.descriptor(), folder.at(file.filename()).c_str(), &old, AT_SYMLINK_NOFOLLOW) == 0 && S_ISREG(old.st_mode))
    (void)::fchmod(d.fd, old.st_mode & 07777);
  requireAsExpected(requested, folder);
  if (!temporary.moveTo(file.filename())) throw systemError(requested, "cannot be written", errno);
  forgetExpected(requested);
}

bool isDevice(const fs::path& file) {
  std::error_code error;
  const fs::file_status status = fs::status(file, error);
  return fs::exists(status) && !fs::is_regular_file(status) && !fs::is_directory(status);
}

/// Through a symbolic link the file it points to is replaced, not the link, unless somebody put it there after the check.
fs::path expectedTarget(const fs::path& requested) {
  std::error_code error;
  fs::path file = requested;
  if (fs::is_symlink(requested, error)) file = fs::weakly_canonical(requested, error);
  if (error) file = requested;
  if (fs::is_directory(file.has_parent_path() ? file.parent_path() : fs::path("."), error))
    requireAsExpected(requested, OpenFolder(file.parent_path()));
  return file;
}

}  // namespace

void atomicWrite(const fs::path& requested, std::string_view content) {
  const fs::path file = expectedTarget(requested);
  if (isDevice(file)) {
    Descriptor d{::open(file.c_str(), O_WRONLY | O_CLOEXEC)};
    if (d.fd < 0) throw systemError(requested, "cannot be written", errno);
    writeAll(d.fd, content, requested);
    if (::close(d.release()) != 0) throw systemError(requested, "cannot be written", errno);
    return;
  }
  checkTarget(file);
  TemporaryPath temporary(file.parent_path(), requested, TemporaryPath::Kind::File);
  writeAll(temporary.descriptor(), content, requested);
  flushAndMove(temporary, file, requested);
}

void atomicWrite(const fs::path& requested, const std::function<void(const fs::path&)>& write) {
  const fs::path file = expectedTarget(requested);
  checkTarget(file);
  TemporaryPath temporary(file.parent_path(), requested, TemporaryPath::Kind::File);
  write(temporary.path());
  std::error_code error;
  const auto size = fs::file_size(temporary.path(), error);
  if (error || size == 0)
    throw InputError(requested.string(), "", "cannot be written (disk full, or the folder is not writable)");
  flushAndMove(temporary, file, requested);
}

std::string readFile(const fs::path& file, std::optional<Limit> limit) {
  // O_NONBLOCK: a pipe without a writer would make this wait for ever; it is refused below.
  Descriptor d{::open(file.c_str(), O_RDONLY | O_CLOEXEC | O_NONBLOCK)};
  if (d.fd < 0) throw systemError(file, "cannot be read", errno);
  struct stat info {};
  if (::fstat(d.fd, &info) != 0) throw systemError(file, "cannot be read", errno);
  if (S_ISDIR(info.st_mode)) throw InputError(file.string(), "", "is a folder, not a file");
  if (!S_ISREG(info.st_mode)) throw InputError(file.string(), "", "is a device or a pipe, not a file");
  constexpr double kMegabyte = 1e6;
  if (limit) requireWithin(*limit, double(info.st_size) / kMegabyte, file.string());
  std::string content;
  content.reserve(static_cast<std::size_t>(info.st_size));
  char buffer[1 << 16];
  while (true) {
    const ssize_t n = ::read(d.fd, buffer, sizeof buffer);
    if (n < 0 && errno == EINTR) continue;
    if (n < 0) throw systemError(file, "cannot be read", errno);
    if (n == 0) break;
    content.append(buffer, static_cast<std::size_t>(n));
    if (limit) requireWithin(*limit, double(content.size()) / kMegabyte, file.string());  // some files of the system have no size
  }
  return content;
}

}  // namespace glint
