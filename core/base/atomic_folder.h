// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <filesystem>
#include <functional>
#include <string>

namespace glint {

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
