// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <string>
#include <vector>

#include "core/diagnose/diagnosis.h"

namespace glint {

struct CandidateChange {
  Change change;
  std::string why;
};

/// Changes worth a trial for this model, quick and promising ones first: filters of its spurious predictions, solvers, the highlights that stand
/// against it left out, readings of the surface, lobes, training frames. Other models are not among them; nor is what finds other highlights
/// (detect.*), which would change what is measured; nor what only hides a failure (fit.most_residual).
/// Stopped.
/// @param inspection  complete, with this model
std::vector<CandidateChange> candidateChanges(const Inspection& inspection, const std::string& model,
                                              const ProgressFn& progress = {});

}  // namespace glint
