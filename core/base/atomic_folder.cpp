// SPDX-License-Identifier: BSD-3-Clause
#include "core/base/atomic_folder.h"

#include <unistd.h>

#include <atomic>
#include <system_error>

#include "core/base/outcome.h"

namespace glint {

namespace fs = std::filesystem;

void atomicFolder(const fs::path& given, const std::function<void(const fs::path&)>& write) {
  fs::path folder = fs::absolute(given).lexically_normal();
  if (!folder.has_filename()) folder = folder.parent_path();  // "labels/"
  std::error_code error;
  const bool exists = fs::exists(folder, error);
  if (exists && !fs::is_directory(folder, error)) throw InputError(given.string(), "", "is a file, not a folder");
  if (exists && !fs::is_empty(folder, error)) throw InputError(given.string(), "", "the folder is not empty; choose a new one");
  static std::atomic<int> number{0};
  const fs::path temporary = folder.parent_path() / ("." + folder.filename().string() + "." + std::to_string(::getpid()) + "." +
                                                     std::to_string(++number));
  fs::create_directories(temporary, error);
  if (error) throw InputError(given.string(), "", "cannot be made: " + error.message());
  try {
    write(temporary);
    if (exists) fs::remove(folder, error);
    fs::rename(temporary, folder, error);
    if (error) throw InputError(given.string(), "", "cannot be made: " + error.message());
  } catch (...) {
    std::error_code ignored;
    fs::remove_all(temporary, ignored);
    throw;
  }
}

}  // namespace glint
