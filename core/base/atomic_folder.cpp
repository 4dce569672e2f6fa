// SPDX-License-Identifier: BSD-3-Clause
#include "core/base/atomic_folder.h"

#include <sys/stat.h>
#include <unistd.h>

#include <algorithm>
#include <cerrno>
#include <cstring>
#include <system_error>
#include <vector>

#include "core/base/outcome.h"
#include "core/base/temporary_path.h"

namespace glint {

namespace fs = std::filesystem;

namespace {

using Write = std::function<void(const fs::path&)>;

[[noreturn]] void cannotBeMade(const fs::path& given, int error) {
  throw InputError(given.string(), "", std::string("cannot be created: ") + std::strerror(error));
}

fs::path absoluteFolder(const fs::path& given) {
  fs::path folder = fs::absolute(given).lexically_normal();
  if (!folder.has_filename()) folder = folder.parent_path();  // "labels/"
  std::error_code error;
  if (const fs::path real = fs::is_symlink(folder, error) ? fs::canonical(folder, error) : fs::path(); !real.empty())
    folder = real;
  return folder;
}

/// Makes the folders above a target; what it made it removes again, unless the target came into being.
struct Parents {
  std::vector<fs::path> made;  // the deepest first
  explicit Parents(const fs::path& folder, const fs::path& given) {
    std::error_code error;
    for (fs::path p = folder; !p.empty() && !fs::exists(p, error) && p.has_relative_path(); p = p.parent_path())
      made.push_back(p);
    fs::create_directories(folder, error);
    if (error) {
      remove();
      cannotBeMade(given, error.value());
    }
  }
  void keep() { made.clear(); }
  ~Parents() { remove(); }
  Parents(const Parents&) = delete;
  Parents& operator=(const Parents&) = delete;

 private:
  void remove() const {
    for (const fs::path& p : made) ::rmdir(p.c_str());  // refused where something else lies in it by now
  }
};

/// `write(temporary)`; its errors name the places where the files were to be.
void fill(const fs::path& temporary, const fs::path& given, const Write& write) {
  try {
    write(temporary);
  } catch (const InputError& e) {
    const std::string inside = temporary.string() + "/";
    if (e.file().compare(0, inside.size(), inside) != 0) throw;
    const std::string file = (given / e.file().substr(inside.size())).string();
    // The reason is what stands behind file and place.
    const std::string start = InputError(e.file(), e.place(), "").what(), whole = e.what();
    throw InputError(file, e.place(), whole.compare(0, start.size(), start) == 0 ? whole.substr(start.size()) : whole);
  }
}

/// A rename can put a new folder in the place of this empty one: same file system, allowed, and nobody's current folder.
bool canBeReplaced(const fs::path& folder) {
  std::error_code error;
  struct stat here {
  }, above{};
  if (!fs::is_empty(folder, error) || error) return false;
  if (::stat(folder.c_str(), &here) != 0 || ::stat(folder.parent_path().c_str(), &above) != 0) return false;
  if (here.st_dev != above.st_dev || ::access(folder.parent_path().c_str(), W_OK) != 0) return false;
  return !fs::equivalent(folder, fs::current_path(error), error);
}

void writeBeside(const fs::path& folder, const fs::path& given, const Write& write) {
  Parents parents(folder.parent_path(), given);
  TemporaryPath temporary(folder.parent_path(), given, TemporaryPath::Kind::Folder);
  fill(temporary.path(), given, write);
  struct stat old {};
  if (::stat(folder.c_str(), &old) == 0) (void)::chmod(temporary.path().c_str(), old.st_mode & 07777);
  if (!temporary.moveTo(folder)) cannotBeMade(given, errno);
  parents.keep();
}

/// A link that somebody put into the folder would lead the files out of it.
void requireNoLink(const fs::path& inside, const fs::path& given) {
  std::error_code ignored;  // what cannot be asked about fails later
  if (fs::is_symlink(inside, ignored))
    throw InputError(given.string(), "", "is a link; nothing is written through it: remove it or choose another folder");
}

/// Moves what `from` holds into `to`: a folder as a whole where there is none yet, else file by file.
void moveInto(const fs::path& from, const fs::path& to, const fs::path& given, const std::string& last) {
  std::vector<fs::path> names;
  for (const fs::directory_entry& entry : fs::directory_iterator(from)) names.push_back(entry.path().filename());
  std::sort(names.begin(), names.end());
  std::stable_partition(names.begin(), names.end(), [&](const fs::path& name) { return name != last; });
  for (const fs::path& name : names) {
    std::error_code ignored;  // what cannot be asked about fails below
    if (fs::is_directory(from / name, ignored)) requireNoLink(to / name, given / name);
    if (fs::is_directory(from / name, ignored) && fs::is_directory(to / name, ignored))
      moveInto(from / name, to / name, given / name, "");
    else if (::rename((from / name).c_str(), (to / name).c_str()) != 0)
      throw InputError((given / name).string(), "", std::string("cannot be written: ") + std::strerror(errno));
  }
}

}  // namespace

void atomicFolder(const fs::path& given, const Write& write) {
  const fs::path folder = absoluteFolder(given);
  std::error_code error;
  const bool exists = fs::exists(folder, error);
  if (exists && !fs::is_directory(folder, error)) throw InputError(given.string(), "", "is a file, not a folder");
  if (exists && !fs::is_empty(folder, error))
    throw InputError(given.string(), "", "the folder is not empty; choose a new folder");
  writeBeside(folder, given, write);
}

void atomicFiles(const fs::path& given, const std::string& main, const Write& write) {
  const fs::path folder = absoluteFolder(given);
  std::error_code error;
  const bool exists = fs::exists(folder, error);
  if (exists && !fs::is_directory(folder, error)) throw InputError(given.string(), "", "is a file, not a folder");
  if (!exists || canBeReplaced(folder)) return writeBeside(folder, given, write);
  TemporaryPath temporary(folder, given / main, TemporaryPath::Kind::Folder);
  fill(temporary.path(), given, write);
  const fs::path whole = temporary.path() / main;
  if (const fs::path above = fs::path(main).parent_path(); !above.empty()) requireNoLink(folder / above, given / above);
  if (!main.empty() && !fs::exists(folder / main, error) && fs::exists(whole, error) &&
      ::rename(whole.c_str(), (folder / main).c_str()) != 0)
    throw InputError((given / main).string(), "", std::string("cannot be written: ") + std::strerror(errno));
  moveInto(temporary.path(), folder, given, main);
}

}  // namespace glint
