// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <optional>
#include <string>
#include <vector>

#include "core/base/solver_trace.h"
#include "core/fit/fit_key.h"
#include "core/inspect/inspection.h"

namespace glint {

/// How a model was fitted to the highlights of one light: every run of a solver on the way, in order.
struct FitTrace {
  FitKey key;
  std::vector<SolverRun> runs;     ///< none if the model is fitted in closed form, or has no view
  std::optional<Failure> failure;  ///< of the fit
};

/// Fits the model again, light by light, and records it: first the light if the model needs one, and a lobe's fit to pixels.
/// Stopped, within a fit of a lobe to pixels or contours too.
std::vector<FitTrace> traceFits(const Inspection& inspection, const HighlightModel& model, const ProgressFn& progress = {});

/// "light with one limit angle: 3 runs, 41 steps; the one that was taken: cost 812 -> 0.31 px^2 in 12 steps, moved 0.42 m". One
/// line per kind of run; distances are of the light, or the centre of the ellipsoid.
std::vector<std::string> textOf(const FitTrace& trace);

}  // namespace glint
