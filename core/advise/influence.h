// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <map>
#include <optional>
#include <string>
#include <vector>

#include "core/pipeline/inspection.h"

namespace glint {

/// What one training frame does for one model: the model is fitted again without the frame.
///
/// Every error in it is capped at kNoPredictionPct (100 %): from there on the prediction lies as far from the highlight as the
/// highlight is large, which is no better than a missing one, and a missing one counts as 100 %. Without the cap one prediction
/// that went wrong (a near-degenerate fit predicts 10,000 %) would decide a mean over all probes, and a frame that turns such a
/// failure into a missing prediction would seem to help by its removal. So a model whose errors are all beyond the cap (`primal`
/// off the plane) shows no influence of any frame: its changes are 0.
struct ModelInfluence {
  std::optional<double> leftOutPct;  ///< contour error on the frame itself, predicted from the others, mean over its highlights
  /// Mean contour error on the probes without the frame; a missing prediction counts as kNoPredictionPct.
  std::optional<double> heldOutPct;
  std::optional<double> changePct;  ///< of that mean against all training frames: positive = the frame helps, negative = it harms
  /// m, between the light (or the ellipsoid's centre) with and without the frame; none at infinity.
  std::optional<double> lightShift;
  std::optional<double> axesChange;  ///< largest relative change of a semi-axis
  std::optional<Failure> failure;    ///< why there is no fit without it
};

struct FrameInfluence {
  int frame = -1;
  std::map<std::string, ModelInfluence> models;
};

/// Leave-one-out over the training frames.
struct Influence {
  std::vector<FrameInfluence> frames;         ///< in order; at most kMostLeftOut, evenly spread
  std::vector<int> probes;                    ///< held-out frames that were predicted each time
  std::map<std::string, double> baselinePct;  ///< mean contour error on the probes with all training frames
  int trainingFrames = 0;                     ///< of which frames.size() were left out
};

/// How much a frame matters to a model: changePct where there are held-out frames, else leftOutPct. None if the frame was not
/// tried or nothing was predicted.
std::optional<double> influenceOf(const Influence& influence, int frame, const std::string& model);

/// Fits every model of the inspection again without each training frame (core/choice/leave_one_out.h), and predicts the frame
/// and some held-out frames. Uses the evidence and views of the inspection; noise on contours is part of them. Several threads;
/// throws Stopped.
/// @param mostProbes  held-out frames with highlights, evenly spread, that are predicted again for every frame and model.
Influence measureInfluence(const Inspection& inspection, const ProgressFn& progress = {}, int mostProbes = 12);

}  // namespace glint
