// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <optional>
#include <string>
#include <vector>

#include "core/advise/highlight_rows.h"
#include "core/pipeline/inspection.h"

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

/// Why a highlight is missed or spurious, in words, by geometry and detection: beside the image, in the object's own shadow,
/// smaller than detect.min_area, at grazing incidence, detected but rejected; else the distance to the nearest of the other kind.
/// @param row  of the comparison, without metrics
/// @return "" for a row with metrics
std::string whyUnmatched(const Inspection& inspection, const FrameComparison& comparison, const FrameComparison::Row& row);

/// What most highlights that a model gets wrong have in common, and hardly any other one has.
struct SharedCause {
  std::string text;                  ///< "4 of 5 have an incident angle above 60°; 0 of 20 others"
  int wrong = 0, ofWrong = 0;        ///< wrong highlights that have it, of those where it is known
  int others = 0, ofOthers = 0;      ///< the same of highlights that are right
  double chance = 1;                 ///< that a split of this size comes by chance: hypergeometric, one-sided
  std::vector<RowKey> highlights{};  ///< the wrong ones that have it
};

/// Strong splits alone: at least three quarters of the wrong highlights (three or more), at most a tenth of the others, and a
/// chance of at most 0.001. What is tried: incident angle, observed diameter, radiance and limit angle, and the frame's position,
/// each above or below the value that splits best; the light, the surface, the image's border, a clipped core. It says what goes
/// together, not what causes what. Wrong is what is not Ok; excluded frames and what was not compared do not count.
/// @param rows  highlightRows() of the inspection
/// @return best first, at most one for each thing that is tried
std::vector<SharedCause> sharedCauses(const Inspection& inspection, const std::vector<HighlightRow>& rows,
                                      const std::string& model);

}  // namespace glint
