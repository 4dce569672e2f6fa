// SPDX-License-Identifier: BSD-3-Clause
#pragma once

// What is known and said of the fits of an inspection.
#include <functional>
#include <string>

#include "core/base/outcome.h"
#include "core/pipeline/fit_engine.h"
#include "core/pipeline/inspection.h"

namespace glint {

/// What the fit of a key is computed from: its training views (on corrected surfaces where there are some), its light, and the
/// lobe of its pixels where it is of all of these views.
FitInput fitInputOf(const Inspection& inspection, const HighlightModel& model, const FitKey& key);

/// A fit for the level at which a frame shows its light's contour: that of a highlight whose peak the image's border cuts off is
/// a fraction of the brightest place that was seen. Empty where the fit itself serves, or where the model does not tell.
std::optional<ModelResult::Fit> fitAtObservedLevel(const ModelResult::Fit& fit, const HighlightModel& model,
                                                   const FrameEvidence& evidence, const Camera& camera, const Surface* surface,
                                                   const Settings& settings);

/// The bands of an inspection's fits of one model, in their order; empty, without words, where a fit failed or no training view
/// is its own. Known lamps of one material share what else explains it.
std::vector<FittedBand> bandsOf(const Inspection& inspection, const HighlightModel& model,
                                const std::vector<ModelResult::Fit>& fits, const ProgressFn& progress = {});

/// Where nobody states which lamps are on: what other lights no training frame shows, and in how many frames this one has no
/// highlight although it would be seen there. "" where that is nothing.
std::string switchedRemark(const Inspection& inspection, const ModelFit& fit,
                           const std::function<std::shared_ptr<const Surface>(int frame)>& surfaceOf);

/// Some frame, whether it trains or not, shows a highlight of this light.
bool isSeen(const Inspection& inspection, const std::string& light);
/// Lights on in most frames of a fit that show no highlight of their own: this one's may be theirs, too. "" without such lights.
std::string mergedRemark(const Inspection& inspection, const ModelFit& fit);
/// That the fit rests on one frame, where several surfaces do not ask for that: its residual and its band cannot show a wrong
/// lamp, since one highlight of one view fits many. "" where several frames hold it, or the scene states the lamp.
std::string oneViewRemark(const Inspection& inspection, const ModelFit& fit);
/// Training frames that show the fit's light and have no view because they repeat another one. "" without such frames.
std::string repeatedRemark(const Inspection& inspection, const ModelFit& fit);
/// How many training highlights of the fit's light serve although the image's border cuts them. "" without such highlights.
std::string cutRemark(const Inspection& inspection, const ModelFit& fit);
/// Training highlights of the fit's light shaped by hand, each with what that leaves in doubt. "" without such highlights.
std::string byHandRemark(const Inspection& inspection, const ModelFit& fit);

/// The lobe that a scene as captured shows: the one that a synthesis of its contours starts from.
struct FittedLobe {
  Lobe lobe = Lobe::TorranceSparrow;
  double roughness = 0.1;  ///< m, > 0
  std::string origin;      ///< "reflectance, light lamp"; "limit angle 4.77° at level 0.5, light lamp"
};
/// That of the model reflectance where it was computed and fitted; else the width at which a Gaussian lobe falls to the contours'
/// level q at the light's limit angle, m = tan(alpha_lim) / sqrt(-log q), as Torrance-Sparrow.
/// @param frame  where there are several lights or surfaces, one of this frame comes first.
/// NotSupported if contours are synthesised (a fit would give back the lobe that made them), or if nothing was computed
/// that tells the lobe; else the reason why the fit failed.
Outcome<FittedLobe> fittedLobe(const Inspection& inspection, int frame);

}  // namespace glint
