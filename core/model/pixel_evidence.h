// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <memory>
#include <vector>

#include "core/model/model.h"
#include "core/reflectance/pixel_fit.h"

namespace glint {

/// Whether there are views that can be used and all of them have their pixels.
bool havePixels(const std::vector<TrainingView>& views);

/// The lobe and light of the views' pixels (core/reflectance/pixel_fit.h), started by what their contours say.
/// @param light  first guess; without it, or where the fit from it is poor, the mean of the reflected peak rays
/// @param near   a fit of these views and a few more: where its lobe and background explain the pixels, no others are tried
/// TooFewViews; the failures of fitPixels(); NotConverged where the lobe leaves more than a tenth of the contours' radius.
/// Stopped.
Outcome<PixelFit> fitViewsPixels(const std::vector<TrainingView>& views, const std::optional<LightEstimate>& light,
                                 const Settings& settings, const ProgressFn& progress = {}, const PixelFit* near = nullptr);

/// A fit to pixels that failed, with its whole question. It takes as long as one that succeeds, so the same question is asked
/// once.
struct UnexplainedPixels {
  std::vector<TrainingView> views;
  std::optional<LightEstimate> light;
  Settings settings;
  Failure failure;
  /// The answer, where fitViewsPixels() would be asked the same: views that were seen, on the same surfaces. Also where some of
  /// the views are left out: what is left out is judged as the whole is fitted, to contours.
  const Failure* answerTo(const std::vector<TrainingView>& otherViews, const std::optional<LightEstimate>& otherLight,
                          const Settings& otherSettings) const;
};

/// The reflectance model from the pixels of a fit's views, taken from FitInput::pixels where that knows it. NotSupported where a view has no pixels; the failures of fitViewsPixels().
Outcome<ModelFit> reflectanceFromPixels(const FitInput& input, const Settings& settings);

}  // namespace glint
