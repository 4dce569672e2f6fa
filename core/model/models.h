// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <array>
#include <memory>
#include <string>

#include "core/base/number_text.h"
#include "core/model/model.h"

namespace glint {

/// One maker per model; registry.cpp lists them from simple to rich.
std::unique_ptr<HighlightModel> makePrimal();
std::unique_ptr<HighlightModel> makeDual();
std::unique_ptr<HighlightModel> makeCanonical();
std::unique_ptr<HighlightModel> makeLimitAngle();
std::unique_ptr<HighlightModel> makeReflectance();

/// How far beyond the image highlights are followed, as a fraction of its longer side: a highlight that the border cuts has its
/// brightest point or a part of its contour out there.
inline constexpr double kMarginFraction = 0.65;

/// predictedBrightestPoints with the settings' search; looks beyond the image by kMarginFraction if the image has no such point.
/// @param hints  ModelFit::hints; used when `predict.search` says so.
Outcome<std::vector<BrightestPoint>> brightestPointsFor(const Surface& surface, const Camera& camera, const Light& light,
                                                        const Settings& settings, const std::vector<SurfacePoint>& hints = {});

/// ModelFit::hints of a fit's input.
std::vector<SurfacePoint> hintsOf(const FitInput& input);

/// Points of a view's contour, equally spaced: n along all of it, without those on the image's border where that cuts it.
std::vector<Pixel> levelSetPoints(const TrainingView& view, int n);

/// Median alpha, rad, over the contour points (equally spaced) that the light reaches: the robust limit angle for a given light.
/// Views with a failure are skipped; 0 when no point is left.
double medianContourAngle(const std::vector<TrainingView>& views, const Light& light, int pointsPerView);

/// Leaves one highlight where several brightest points share one contour: those whose peak lies inside a larger predicted
/// contour are dropped (method.md section 8: a component that encloses several brightest points is returned once).
void dropEnclosed(std::vector<PredictedHighlight>& highlights);

/// Colour of a model (ModelTraits::rgb); grey for an unknown one.
inline std::array<int, 3> modelRgb(const std::string& model) {
  const HighlightModel* const found = findModel(model);
  return found ? found->traits().rgb : std::array<int, 3>{153, 153, 153};
}

/// The same as HTML writes it, "#d55e00".
inline std::string modelHex(const std::string& model) {
  const std::array<int, 3> c = modelRgb(model);
  return formatted("#%02x%02x%02x", c[0], c[1], c[2]);
}

}  // namespace glint
