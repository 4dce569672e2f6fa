// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <filesystem>
#include <string>
#include <string_view>

namespace glint {

/// Text from a file or a name, fit for a terminal: control characters (terminal escapes among them), marks that turn the
/// direction of writing, and bytes that are not UTF-8 become xNN or uNNNN behind a backslash. Line ends and tabs stay.
std::string withoutControls(std::string_view text);

/// The longest message that a person is shown, in bytes: with "glint: warning: " before it, a line stays below 400.
inline constexpr std::size_t kLongestMessage = 380;

/// One line for a person: `withoutControls`, line ends and tabs as blanks, words longer than 160 bytes (paths) and what is then
/// still longer than `most` bytes shortened in the middle ("…").
std::string messageLine(std::string_view text, std::size_t most = kLongestMessage);

/// An id as the name of a file or folder, without an extension: never empty, never a path, never hidden. Slashes, backslashes,
/// '%', a leading dot, dots in a row, and what `withoutControls` shows escaped (line ends and tabs too) become %XX for each byte;
/// an id longer than 180 bytes is cut and ends in its hash. Equal names have equal ids. An id of letters, digits, '-', '_',
/// single dots inside and the like stays as it is.
std::string fileNameOf(std::string_view id);

/// The name of a copy of `file`, as `fileNameOf` makes it: "b.ply", and "b-2.ply" for the second of one name. An extension of
/// other characters than ASCII letters and digits counts as a part of the stem.
std::string copyNameOf(const std::filesystem::path& file, int number = 1);

}  // namespace glint
