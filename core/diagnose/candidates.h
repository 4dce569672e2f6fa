// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <string>
#include <vector>

#include "core/diagnose/diagnosis.h"

namespace glint {

struct CandidateChange {
  Change change;
  std::string why;
  bool slow = false;         ///< needs highlights or views found anew: seconds, where others need a tenth of one
  bool newContours = false;  ///< the highlights are found anew: contours of other frames are not comparable
};

/// Changes worth a trial for this model, most promising first, slow ones last: other solvers, the highlights that stand against it left out, other
/// readings of the surface, other training frames, other contours. Never one that only hides a failure (fit.most_residual). Other models are not among them.
std::vector<CandidateChange> candidateChanges(const Inspection& inspection, const HighlightModel& model,
                                              const std::vector<HighlightEvidence>& evidence);

}  // namespace glint
