// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <filesystem>
#include <functional>
#include <memory>
#include <optional>

namespace glint {

/// A folder that is opened once. What is made, looked up and moved in it by name happens in this folder, whatever somebody puts
/// in the place of its path meanwhile.
class OpenFolder {
 public:
  /// Follows links. Where the system does not open it, names are looked up by its path.
  explicit OpenFolder(const std::filesystem::path& folder);
  /// The folder of this name in it. Nothing, with errno, if it is missing or a link.
  std::optional<OpenFolder> below(const std::filesystem::path& name) const;

  const std::filesystem::path& path() const { return path_; }
  int descriptor() const;                                             ///< for openat() and its kind
  std::filesystem::path at(const std::filesystem::path& name) const;  ///< what they take for this name

 private:
  OpenFolder(std::filesystem::path path, int descriptor);
  std::filesystem::path path_;
  std::shared_ptr<const int> descriptor_;
};

/// A program writes long after it has checked where: in a folder of several users somebody may put a link or a file there
/// meanwhile. Says that the check passed for this file or folder; the next `requireAsExpected` of this path in this process
/// compares it with what is there then. A later call for the same path takes the place of an earlier one.
/// @param stillAllowed  the check once more, false = what is there now must not be replaced
void expectOutput(const std::filesystem::path& path, std::function<bool()> stillAllowed);

/// Called with the folder that is written into, after it was opened. Does nothing for an unexpected path.
/// @throw InputError (file) if a link on the way to the path appeared or changed since `expectOutput`, or its target is forbidden
void requireAsExpected(const std::filesystem::path& path, const OpenFolder& folder);

/// The write is done: the next one of this path is another one.
void forgetExpected(const std::filesystem::path& path);

}  // namespace glint
