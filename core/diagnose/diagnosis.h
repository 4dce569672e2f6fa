// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <functional>
#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "core/diagnose/fit_trace.h"
#include "core/diagnose/highlight_evidence.h"
#include "core/diagnose/left_out_error.h"
#include "core/inspect/inspection.h"

namespace glint {

/// What a user could change, as the flags of `glint evaluate` take it. Exactly one is set, or one together with `exclude`.
struct Change {
  std::optional<std::string> model = {};    ///< use this one instead
  std::optional<std::string> train = {};    ///< SPEC
  std::optional<std::string> set = {};      ///< "light.solver=triangulated"
  std::optional<std::string> exclude = {};  ///< SPEC of all frames to exclude, those that are excluded already among them
  friend bool operator==(const Change&, const Change&) = default;
};
/// "--model limit-angle", "--set light.solver=triangulated".
std::string flagsOf(const Change& change);
/// The request with the change. InputError where the scene does not know a frame.
InspectionRequest with(InspectionRequest request, const Change& change, const Scene& scene);

/// A change that helps, and how much: measured, not guessed.
struct Remedy {
  Change change;
  std::string why;  ///< why it was tried, one clause
  /// Over the views that both have, none of them seen by the fit that predicts it: left-out training views, and some held-out frames. A change
  /// that makes other contours is measured by the left-out training views alone.
  LeftOutError before, after;
  /// False where frames that the model gets wrong are only left out of the score: `after` is smaller by definition, and the remedy stands last.
  bool measured = true;
};

struct ModelDiagnosis {
  enum class Status { Ok, Poor, Failed };
  std::string model;
  Status status = Status::Ok;
  std::vector<std::string> causes;  ///< in words, weightiest first; none where the status is Ok
  std::vector<std::string> notes;   ///< whatever the status: what errors of contours do not show, see spuriousNote()
  LeftOutError unseen;              ///< as it is now: left-out training views and some held-out frames
  std::vector<HighlightEvidence> evidence;
  std::vector<FitTrace> fits;    ///< how they went; none where the status is Ok
  std::vector<Remedy> remedies;  ///< best first
  int tried = 0;                 ///< changes that were measured
  int known = 0;                 ///< changes that could have been
};
const char* nameOf(ModelDiagnosis::Status status);  ///< "ok", "poor", "failed"

struct Diagnosis {
  std::vector<ModelDiagnosis> models;  ///< in the order of the request
};

struct DiagnoseOptions {
  int mostTried = 8;  ///< changes measured for each model that is not Ok, other models aside: the bound of the work
  /// Also the richest model where it was not asked for, and changes where another model has brought the error under kLargestExpectedPct with every
  /// view answered, at most a quarter of them left out. Without it, a model with a lobe gets half as many changes.
  bool slowToo = false;
  /// Called with each remedy as soon as it is measured, before they are sorted; another thread's caller may show it.
  std::function<void(const std::string& model, const Remedy&)> found;
};

/// Why each model of the inspection's request fails or is poor, and what helps. Poor: the mean error of the views that its fit did not see is over
/// kLargestExpectedPct, among the left-out training views or among the held-out frames, or one of them is not predicted. A remedy that was chosen
/// by what held-out frames show makes them less independent: `evaluate` on other frames judges it.
/// An exclusion is measured with the contours as they are: where a lobe is taken off the background (detect.background = lobe), it stays that of all
/// training frames. Stopped.
/// @param inspection  complete
Diagnosis diagnose(const Inspection& inspection, const DiagnoseOptions& options = {}, const ProgressFn& progress = {});

}  // namespace glint
