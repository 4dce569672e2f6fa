// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <filesystem>
#include <functional>
#include <optional>
#include <string>
#include <string_view>

#include "core/base/limits.h"

namespace glint {

/// Writes a whole file or nothing: a temporary file beside it, flushed to the disk (fsync), then renamed over it.
/// A reader sees the old content or the new one, never a part; a failed write leaves no temporary file.
/// A device or pipe (/dev/null, /dev/full) cannot be renamed over and is written directly.
/// @throw InputError (file = the target) if the folder is missing or not writable or the disk is full.
void atomicWrite(const std::filesystem::path& file, std::string_view content);

/// The same for writers that need a path (image and video encoders): `write` gets a temporary path in the same folder
/// with the same extension and may throw; what it left is flushed and renamed, or removed when it threw.
/// @throw InputError if the temporary file is missing or empty afterwards or cannot be renamed; whatever `write` throws.
void atomicWrite(const std::filesystem::path& file, const std::function<void(const std::filesystem::path& temporary)>& write);

/// Removes the temporary files of writes that are under way, for a program that ends at once (after Ctrl-C).
void removeUnfinishedWrites();

/// A file's bytes. InputError if it is missing, no regular file (a folder, a device), beyond the limit (in megabytes), or
/// cannot be read.
std::string readFile(const std::filesystem::path& file, std::optional<Limit> limit = std::nullopt);

/// Writes a whole folder or nothing: `write` fills a temporary one beside it, which is then renamed; when it throws, nothing
/// stays.
/// @throw InputError (file = the folder) if it exists and is not an empty folder, or cannot be made; whatever `write` throws,
/// where it names a file of the temporary folder with the name that it was to have.
void atomicFolder(const std::filesystem::path& folder, const std::function<void(const std::filesystem::path& temporary)>& write);

/// Writes the files of one answer into a folder that may hold other things, or nothing: `write` fills a temporary folder. A
/// folder that is new or empty then appears as a whole. Into another one the finished files are moved one after the other, each
/// of them whole; a program that is killed just then leaves some of them old. `main` is the file by which the answer is found
/// again: it is moved last where there is an old one, and else first, so that there is one at any time of the move.
/// @throw InputError (file = the folder or a file in it); whatever `write` throws, with names as above.
void atomicFiles(const std::filesystem::path& folder, const std::string& main,
                 const std::function<void(const std::filesystem::path& temporary)>& write);

}  // namespace glint
