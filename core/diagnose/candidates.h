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

/// Changes worth a trial for this model, quick and promising ones first: filters of its spurious predictions, solvers, dropped
/// highlights that contradict it, readings of the surface, lobes, training frames. Leaves out other models, settings that change
/// what is measured by finding other highlights (detect.*), and what only hides a failure (fit.most_residual).
/// Stopped.
/// @param inspection  complete, with this model
std::vector<CandidateChange> candidateChanges(const Inspection& inspection, const std::string& model,
                                              const ProgressFn& progress = {});

}  // namespace glint
