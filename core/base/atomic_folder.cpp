// SPDX-License-Identifier: BSD-3-Clause
#include <fcntl.h>
#include <sys/stat.h>
#include <unistd.h>

#include <algorithm>
#include <cerrno>
#include <cstring>
#include <optional>
#include <system_error>
#include <vector>

#include "core/base/atomic_file.h"
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
    for (const fs::path& p : made) ::rmdir(p.c_str());  // refused if something else lies in it by now
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
    // The reason is the text behind file and place.
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
  if (::stat(folder.c_str(), &old) == 0) (void)::fchmod(temporary.descriptor(), old.st_mode & 07777);
  requireAsExpected(given, temporary.folder());
  if (!temporary.moveTo(folder.filename())) cannotBeMade(given, errno);
  forgetExpected(given);
  parents.keep();
}

/// Moves one file, or a folder that does not exist yet.
void moveOne(const OpenFolder& from, const OpenFolder& to, const fs::path& name, const fs::path& given) {
  requireAsExpected(given / name, to);
  if (::renameat(from.descriptor(), from.at(name).c_str(), to.descriptor(), to.at(name).c_str()) != 0)
    throw InputError((given / name).string(), "", std::string("cannot be written: ") + std::strerror(errno));
  forgetExpected(given / name);
}

/// The folder of this name, to move files into it. Nothing if it is missing, or a link, which would lead them out.
std::optional<OpenFolder> folderIn(const OpenFolder& folder, const fs::path& name, const fs::path& given) {
  std::error_code ignored;  // what cannot be asked about fails later
  std::optional<OpenFolder> found = folder.below(name);
  if (!found && fs::is_symlink(folder.path() / name, ignored))
    throw InputError((given / name).string(), "", "is a link; nothing is written through it: remove it or choose another folder");
  return found;
}

/// Moves what `from` holds into `to`: a folder as a whole where `to` lacks it, else file by file.
void moveInto(const OpenFolder& from, const OpenFolder& to, const fs::path& given, const std::string& last) {
  std::vector<fs::path> names;
  for (const fs::directory_entry& entry : fs::directory_iterator(from.path())) names.push_back(entry.path().filename());
  std::sort(names.begin(), names.end());
  std::stable_partition(names.begin(), names.end(), [&](const fs::path& name) { return name != last; });
  for (const fs::path& name : names) {
    const std::optional<OpenFolder> own = from.below(name), there = own ? folderIn(to, name, given) : std::nullopt;
    if (there)
      moveInto(*own, *there, given / name, "");
    else
      moveOne(from, to, name, given);
  }
}

/// Moves the file by which the answer is found first, where it does not exist yet.
void moveNewMain(const OpenFolder& from, const OpenFolder& to, const fs::path& main, const fs::path& given) {
  std::error_code error;  // what cannot be asked about fails later
  const fs::path above = main.parent_path();
  const std::optional<OpenFolder> own = above.empty() ? from : from.below(above),
                                  there = above.empty() ? to : folderIn(to, above, given);
  if (own && there && !fs::exists(there->path() / main.filename(), error) && fs::exists(own->path() / main.filename(), error))
    moveOne(*own, *there, main.filename(), given / above);
}

}  // namespace

void atomicFolder(const fs::path& given, const Write& write) {
  const fs::path folder = absoluteFolder(given);
  requireAsExpected(given, OpenFolder(folder.parent_path()));
  std::error_code error;
  const bool exists = fs::exists(folder, error);
  if (exists && !fs::is_directory(folder, error)) throw InputError(given.string(), "", "is a file, not a folder");
  if (exists && !fs::is_empty(folder, error))
    throw InputError(given.string(), "", "the folder is not empty; choose a new folder");
  writeBeside(folder, given, write);
}

void atomicFiles(const fs::path& given, const std::string& main, const Write& write) {
  const fs::path folder = absoluteFolder(given);
  requireAsExpected(given, OpenFolder(folder.parent_path()));
  std::error_code error;
  const bool exists = fs::exists(folder, error);
  if (exists && !fs::is_directory(folder, error)) throw InputError(given.string(), "", "is a file, not a folder");
  if (!exists || canBeReplaced(folder)) return writeBeside(folder, given, write);
  const OpenFolder to(folder);
  TemporaryPath temporary(to, given / main, TemporaryPath::Kind::Folder);
  fill(temporary.path(), given, write);
  requireAsExpected(given, OpenFolder(folder.parent_path()));
  const std::optional<OpenFolder> from = to.below(temporary.name());
  if (!from) throw InputError(given.string(), "", std::string("cannot be written: ") + std::strerror(errno));
  if (!main.empty()) moveNewMain(*from, to, main, given);
  moveInto(*from, to, given, main);
  forgetExpected(given);
}

}  // namespace glint
