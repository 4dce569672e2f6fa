// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <optional>
#include <string>
#include <vector>

#include "core/inspect/inspection.h"
#include "core/inspect/summary.h"

namespace glint {

/// The bands of a model's matched highlights in held-out frames (all frames where every surface has its own model), each
/// highlight counted alike. Nothing without predict.band.
std::optional<BandScore> bandSummary(const Inspection& inspection, const ModelResult& result);

/// Remarks on the bands of a model: how wide they are, how many vertices they hold, and the remarks of its fits, each
/// with the light where there are several fits. Empty without predict.band.
std::vector<std::string> bandLines(const Inspection& inspection, const ModelResult& result);

}  // namespace glint
