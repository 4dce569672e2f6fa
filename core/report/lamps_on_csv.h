// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <string>

#include "core/lamps/lamps_on.h"
#include "core/scene/scene.h"

namespace glint {

/// The first line of `lampsOnCsv`.
extern const char* const kLampsOnCsvHeader;
/// docs/formats.md, "lights --on": one row for each lamp in each frame, then one for each highlight that no lamp explains.
std::string lampsOnCsv(const LampsOn& lamps, const Scene& scene);
/// One line for people: how many lamps are on, off and so on.
std::string lampsOnSummary(const LampsOn& lamps);

}  // namespace glint
