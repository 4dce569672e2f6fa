// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <string>

namespace glint {

/// One more legal value of a setting that names one of several (core/base/settings.h). Not thread-safe: before anything reads
/// settings. std::invalid_argument for a setting that does not exist or has no list of values.
void addChoice(const std::string& key, const std::string& choice);

}  // namespace glint
