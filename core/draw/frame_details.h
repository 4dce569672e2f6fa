// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <functional>
#include <vector>

#include "core/draw/frame_overlay.h"

namespace glint::draw {

/// Contours live in ideal pixels; the photograph on screen is the distorted one.
std::vector<Pixel> toPhotograph(const Camera& camera, const std::vector<Pixel>& ideal);

/// Ideal pixel from which Selection::direction is measured: centroid of the observed contour, its peak without a contour.
/// Nothing if the frame has no such highlight.
std::optional<Pixel> directionOrigin(const Inspection& inspection, int frame, int highlight);

/// The observed highlight that a predicted one was matched with; -1 if it is spurious.
int observedOf(const FrameComparison& comparison, int predicted);

/// Crossing of the half line from `origin` (ideal pixels) with the parts of a prediction that do not bridge a gap.
std::optional<Pixel> onPrediction(const PredictedHighlight& highlight, const Pixel& origin, double direction);

/// One line (shaft and head) per direction where both contours answer. @param style  role, colour, model of the lines.
void addResidualArrows(const Inspection& inspection, const FrameComparison& comparison, int predicted, const Camera& camera,
                       const OverlayLine& style, double scale, std::vector<OverlayLine>& lines);

/// Walks of the training view's canonical contour; in other frames those of the prediction of the selected model, or of the
/// simplest drawn one that walks.
void addLimitDirections(const Inspection& inspection, int frame, const std::function<bool(const std::string&)>& drawn,
                        const Selection* selected, std::vector<OverlayLine>& lines);

/// The selected direction on the observed contour and on the predicted ones.
void addSelectedPoint(const Inspection& inspection, const Selection& selection, const std::function<bool(OverlayRole)>& shown,
                      const std::function<bool(const std::string&)>& drawn, std::vector<OverlayMark>& marks);

}  // namespace glint::draw
