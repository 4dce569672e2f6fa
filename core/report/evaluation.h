// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "core/base/progress.h"
#include "core/pipeline/inspection.h"
#include "core/report/report.h"

namespace glint {

/// What a person asks of an evaluation beyond the request.
struct EvaluationQuestion {
  bool choose = false;                  ///< the model, automatically: the request's models do not count
  std::optional<double> goodEnoughPct;  ///< with `choose`: contour error that is good enough, percent
  bool keepWalks = false;               ///< with `choose`: predict.query stays as the request has it
};

struct Evaluation {
  Inspection inspection;
  ReportContext report;            ///< as it was given, with the choice
  std::string choice;              ///< with `choose`: the candidates and the sentence, for a person; ends with an empty line
  std::optional<Failure> failure;  ///< why no model answered; of a request without models: why no training view could be used
};

/// What `glint evaluate` does, for every program that evaluates: inspects the scene with the request's models, or chooses one by
/// the training frames and inspects with that. InputError as inspect(); Stopped.
/// @param report    what is known already: input, program, the reason of the level
/// @param previous  see inspect()
Evaluation evaluate(std::shared_ptr<const Scene> scene, InspectionRequest request, ReportContext report,
                    const EvaluationQuestion& question = {}, const ProgressFn& progress = {},
                    const Inspection* previous = nullptr);

/// "frame ID: reason" of every training frame without a usable highlight.
std::vector<std::string> unusedTrainingFrames(const Inspection& inspection);
/// Why no training view could be used at all, with the first reason; nothing if one could.
std::optional<Failure> noUsableView(const Inspection& inspection);

}  // namespace glint
