// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include "core/fit/band.h"
#include "core/inspect/inspection.h"

namespace glint {

/// What the fit of a key is computed from: its training views (on corrected surfaces where there are some), its light, and the
/// lobe of its pixels where it is of all of these views.
FitInput fitInputOf(const Inspection& inspection, const HighlightModel& model, const FitKey& key);

/// The band of an inspection's fit; empty, without words, if the fit failed or no training view is its own.
FittedBand bandOf(const Inspection& inspection, const HighlightModel& model, const ModelResult::Fit& fit);

}  // namespace glint
