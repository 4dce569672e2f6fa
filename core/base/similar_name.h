// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <string>
#include <vector>

namespace glint {

/// Insertions, deletions, replacements and swaps of neighbours that turn one text into another, byte by byte (optimal string
/// alignment: edits no part twice). @see Damerau, A technique for computer detection and correction of spelling errors, 1964.
int editDistance(const std::string& a, const std::string& b);

/// The known name that was most likely meant: the nearest one, where at most a third of the given name is wrong; the first of
/// equally near ones. "" if none is near, and for names beyond 100 bytes, which people do not type.
std::string similarName(const std::string& given, const std::vector<std::string>& known);

/// "; did you mean 'NAME'?", "" if no name is near.
std::string didYouMean(const std::string& given, const std::vector<std::string>& known);

}  // namespace glint
