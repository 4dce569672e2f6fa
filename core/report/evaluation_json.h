// SPDX-License-Identifier: BSD-3-Clause
#pragma once

// Internal to this folder: the evaluation as JSON text, and the pieces of it that a merge of parts makes anew. Texts, because the JSON library's
// document stays in sources.

#include <optional>
#include <string>
#include <utility>
#include <vector>

#include "core/inspect/summary.h"
#include "core/report/detection_error.h"
#include "core/report/report.h"

namespace glint::evaluation {

/// One row per highlight of a comparison, or one that says why there is none: an array, and how many it has.
std::string rowsJson(const Inspection& inspection, const ModelResult& result, const FrameComparison& comparison);
int rowCount(const FrameComparison& comparison);
std::string summaryJson(const ModelSummary& summary);
std::string detectionJson(const DetectionError& error);
/// `sigma_px` and `coverage_95` of a model's `band`.
std::string bandJson(const std::optional<BandScore>& score);

/// By name, in the order of the request.
BestModel bestOf(const std::vector<std::pair<std::string, ModelSummary>>& models);

}  // namespace glint::evaluation
