// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <optional>
#include <string>
#include <vector>

#include "core/base/outcome.h"
#include "core/geometry/camera.h"
#include "core/model/model.h"
#include "core/pipeline/frame_evidence.h"
#include "core/pipeline/metrics.h"

namespace glint {

/// How a predicted contour's band does against the observed one; the surface's own edge has no band and does not count.
struct BandScore {
  double sigmaPx = 0;   ///< mean over the vertices
  double coverage = 0;  ///< share of the observed points within 1.96 sigma, with the observed contour's own noise beside it
};

/// Prediction of one model for one light in one frame, compared with the evidence.
struct FrameComparison {
  int frame = -1;
  std::string light;
  int fit = -1;  ///< index into the fits of the model
  Prediction prediction;
  /// One row per matched pair, per missed observed and per spurious predicted highlight.
  struct Row {
    int observed = -1;   ///< index into FrameEvidence::scored(); -1 = spurious
    int predicted = -1;  ///< index into prediction.highlights(); -1 = missed
    std::optional<ContourMetrics> metrics;
    std::optional<Failure> failure;
    std::optional<BandScore> band;  ///< of a matched pair whose prediction has a band
  };
  std::vector<Row> rows;
  double iou = 0;  ///< over the union of all regions of this light
};

/// @param cut  the image's border cuts one of them: the parts that both show are compared
ContourMetrics comparedHighlights(const Highlight& observed, const PredictedHighlight& predicted, const Camera& camera, bool cut,
                                  std::optional<double> iou = {});

/// Matches a prediction with the frame's scored highlights of one light by overlap and measures each pair (method.md
/// section 10); what has no partner becomes a row of its own. Where the image's border cuts an observed contour, predictions are
/// clipped, too, and the parts that both show are compared. What lies outside of the image is neither missed nor spurious.
FrameComparison compareFrame(const FrameEvidence& evidence, const std::string& light, const Camera& camera,
                             Prediction prediction);

}  // namespace glint
