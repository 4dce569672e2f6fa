// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <optional>
#include <string>
#include <vector>

#include "core/choice/selection.h"
#include "core/pipeline/inspection.h"

namespace glint {

/// Facts about a run that the inspection does not hold.
struct ReportContext {
  std::string input;                   ///< as the user named it
  std::string chosenModel;             ///< "" = none
  std::string whyChosen;               ///< one sentence
  std::optional<Selection> selection;  ///< what the automatic choice tried
  std::string levelReason;             ///< why this contour level, where the program chose it; "" = it was given
  std::string program;                 ///< "glint 0.4.0"; "" = not said
  std::vector<std::string> advice;     ///< of a diagnosis: its verdict, then its remedies, in words; empty = not asked for
};

/// The answered model with the smallest held-out error (ModelSummary::wrongPct), if possible with a fit that is not poor.
struct BestModel {
  std::string model;  ///< "" = none answered
  std::string why;    ///< one sentence; "" = none answered
};
BestModel bestModel(const Inspection& inspection);

/// docs/formats.md, "evaluate --json". Numbers that are not finite become null.
std::string evaluationJson(const Inspection& inspection, const ReportContext& context);
/// The first line of `evaluationCsv`.
extern const char* const kEvaluationCsvHeader;
/// One row per (model, frame, light, highlight), with a header row.
std::string evaluationCsv(const Inspection& inspection);
/// A plain-text table of the models: error statistics, predicted/frames, coverage, counts, time.
std::string evaluationTable(const Inspection& inspection);
/// One self-contained page: table, error over frames per model, the worst frames with overlays.
std::string evaluationHtml(const Inspection& inspection, const ReportContext& context);

struct Diagnosis;
/// docs/formats.md, "diagnose --json".
/// @param input  as given
std::string diagnosisJson(const Inspection& inspection, const Diagnosis& diagnosis, const std::string& input);
/// For a person: the verdict, the remedies as flags, and their reasons, one cause per model that is not good; --json has all.
std::string diagnosisText(const Inspection& inspection, const Diagnosis& diagnosis);
/// ReportContext::advice.
std::vector<std::string> adviceOf(const Diagnosis& diagnosis);

struct Tradeoff;
/// A page that needs no other file: the front as SVG, the points, what was pruned and why.
std::string tradeoffHtml(const Tradeoff& tradeoff);

}  // namespace glint
