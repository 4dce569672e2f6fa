// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "core/base/progress.h"
#include "core/model/band.h"
#include "core/pipeline/surface_correction.h"

namespace glint {

/// The light of some training views, with what their contours correct of the surface that they lie on.
struct LightFit {
  Outcome<LightEstimate> light;
  std::vector<TrainingView> views;  ///< in the order given, on the corrected surface where there is a correction
  SurfaceCorrection correction;
};

/// The one way from views to a light: estimateLight(), then what light.smooth_mesh, light.refine_depth and light.refine_normals
/// ask for. A correction is kept where the views on the corrected surface keep what it promised.
/// @param views   of one light, and of one surface where models are per surface; on the surfaces as they are given.
/// @param chosen  that of more views of this light, see chosenFor(): its smoothed mesh serves, and no other is looked for; may be
///                null.
LightFit fitLight(std::vector<TrainingView> views, const Scene& scene, const SurfaceCache& surfaces, const Settings& settings,
                  const SurfaceCorrection* chosen = nullptr);

/// What a model is fitted to: the views, with canonical contours under the light where the model needs them and a view has none.
/// @param light     for models that need one; empty if none was asked for.
/// @param pixels    what fits to these and other views' pixels have said.
FitInput fitInput(const HighlightModel& model, std::vector<TrainingView> views,
                  const std::optional<Outcome<LightEstimate>>& light, const Settings& settings, KnownPixels pixels = {},
                  const ProgressFn& progress = {});

/// Fits a model to that input. Fails as the model does.
Outcome<ModelFit> fitModel(const HighlightModel& model, std::vector<TrainingView> views,
                           const std::optional<Outcome<LightEstimate>>& light, const Settings& settings, KnownPixels pixels = {},
                           const ProgressFn& progress = {});

/// A fit's band (predict.band), and remarks about it, in words.
struct FittedBand {
  std::shared_ptr<const Band> band;  ///< null without one
  std::vector<std::string> remarks;
};

/// Another model, or the same one with another lobe, fitted to the same evidence.
struct OtherFit {
  const HighlightModel* model = nullptr;
  ModelFit fit;
  std::string name;  ///< "the lobe ggx"
};
/// The other lobes of a reflectance fit; reflectance beside the limit angle. What does not explain its views stands beside
/// nothing but a poor fit. A few fits, none of them cached.
std::vector<OtherFit> otherFits(const HighlightModel& model, const ModelFit& fit, const FitInput& input,
                                const Settings& settings);

/// The band of a fit with its alternatives: others by the share of evidence that their residuals leave them; and the fit repeated
/// with the cameras that a scale or focal length off by its stated tolerance (input.scale_tolerance, input.focal_tolerance)
/// amounts to.
/// @param others  otherFits() of the fit. @param surfaceRefined  the views' surfaces are corrected depth maps or meshes
FittedBand bandOf(const HighlightModel& model, const ModelFit& fit, const FitInput& input, const Settings& settings,
                  const std::vector<OtherFit>& others, bool surfaceRefined);

}  // namespace glint
