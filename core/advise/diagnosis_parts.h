// SPDX-License-Identifier: BSD-3-Clause
#pragma once

// Internal to core/advise: the steps of diagnosis.cpp.
#include <optional>
#include <string>
#include <vector>

#include "core/advise/diagnosis.h"

namespace glint {

/// The change with contours alone as evidence, which takes seconds where pixels take a minute. If pixels fail again, both predict
/// the same.
/// Nothing where that saves nothing: the pixels of the base were explained, or the change does not fit them again.
/// @param base   complete, with the model
/// @param model  of the change
std::optional<Change> byContours(const Inspection& base, const Change& change, const std::string& model);

struct CandidateChange {
  Change change;
  std::string why;
};

/// Changes worth a trial for this model, quick and promising ones first: filters of its spurious predictions, solvers, dropped
/// highlights that contradict it, readings of the surface, lobes, training frames. Leaves out other models, settings that change
/// what is measured by finding other highlights (detect.*), and what only hides a failure (fit.most_residual).
/// Stopped.
/// @param inspection  complete, with this model
std::vector<CandidateChange> candidateChanges(const Inspection& inspection, const std::string& model,
                                              const ProgressFn& progress = {});

/// Why a model is ok, poor or failed: its fits, the highlights that contradict it, the views that it gets wrong.
/// @param inspection  complete, with this model
/// @param error       of it, in views that its fit did not see
/// Stopped.
ModelDiagnosis diagnosisOf(const Inspection& inspection, const std::string& model, const UnseenError& error,
                           const ProgressFn& progress);

}  // namespace glint
