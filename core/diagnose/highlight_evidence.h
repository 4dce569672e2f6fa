// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <optional>
#include <string>
#include <vector>

#include "core/inspect/inspection.h"

namespace glint {

/// One training highlight as one model sees it.
struct HighlightEvidence {
  int frame = -1;
  std::string light;   ///< id
  int highlight = -1;  ///< its index in the frame's evidence; -1 if it is not among it
  Pixel peak{0, 0};    ///< ideal pixels
  double radiusPx = 0;
  /// What the model leaves of its contour (residualMeaning()), also if the fit was refused for it; none if there is no fit.
  std::optional<double> residualPx;
  /// rad: median of alpha along its contour under the common light; of the peaks alone where its
  /// bundle failed. None if there is no light, or the view is not usable.
  std::optional<double> limitAngle;
  std::vector<std::string> against;  ///< how it contradicts the model, in words, weightiest first
  double weight = 0;                 ///< how much it contradicts the model: 0 = not at all, 1 = clearly
};

/// Highlights of the training frames, in the order of Inspection::views. A fit that failed is made again with fit.most_residual
/// at its largest, so that it shows what it leaves. Stopped, as traceFits().
/// @param inspection  with evidence, views, and the lights if the model needs one
std::vector<HighlightEvidence> highlightEvidence(const Inspection& inspection, const HighlightModel& model,
                                                 const ProgressFn& progress = {});

/// Two highlights of one light whose limit angles lie too far apart for one limit angle to fit both; null without such a pair.
struct LimitConflict {
  const HighlightEvidence* wide = nullptr;
  const HighlightEvidence* narrow = nullptr;
};
LimitConflict limitConflict(const std::vector<HighlightEvidence>& evidence);

}  // namespace glint
