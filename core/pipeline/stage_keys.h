// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <set>
#include <string>

#include "core/pipeline/inspection.h"

namespace glint {

/// 17 significant digits: equal for equal numbers alone.
std::string exactText(double v);

/// Text that is equal when every input of a stage is: the values of all settings of the named stages, and `more`.
std::string keyOfStages(const Settings& settings, const std::set<std::string>& stages, const std::string& more);

/// What the evidence of a frame depends on, the user's changes to single highlights apart.
/// @param together  lights are told apart from all frames (lightsAreOpenIn()): surfaces and poses matter as well
std::string detectKey(const InspectionRequest& request, bool together);

}  // namespace glint
