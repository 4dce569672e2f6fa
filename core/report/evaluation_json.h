// SPDX-License-Identifier: BSD-3-Clause
#pragma once

// Internal to this folder: the evaluation as a JSON document, and its pieces that a merge of parts makes anew.

#include <nlohmann/json_fwd.hpp>
#include <optional>
#include <string>

#include "core/inspect/summary.h"
#include "core/report/detection_error.h"
#include "core/report/report.h"

namespace glint::evaluation {

using Json = nlohmann::ordered_json;

/// docs/formats.md, "evaluate --json".
Json document(const Inspection& inspection, const ReportContext& context);
std::string textOf(const Json& document);

/// Appends one row per highlight of a comparison, or one that says why there is none.
void addRows(const Inspection& inspection, const FrameComparison& comparison, Json& rows);
Json summaryJson(const ModelSummary& summary);
Json detectionJson(const DetectionError& error);
/// `sigma_px` and `coverage_95` of a model's `band`.
void setBand(Json& band, const std::optional<BandScore>& score);

/// By name, in the order of the request.
BestModel bestOf(const std::vector<std::pair<std::string, ModelSummary>>& models);

}  // namespace glint::evaluation
