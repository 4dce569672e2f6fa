// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <functional>

#include "core/model/model.h"

namespace glint {

/// Smallest radius of a highlight that is an answer, px: the best detection places a contour to 0.02 px, a tenth of this, which
/// is the share of the radius beyond which a fit is refused (the default of fit.most_residual).
inline constexpr double kLeastRadiusPx = 0.2;

/// Radius of the disc with the area of a closed contour, px.
double radiusPx(const Polyline& contour);
/// Standard deviation of the noise of single contour points across the contour, px, from second differences of their distances
/// from the middle (robustly): what a detector or a model gets wrong is smooth along a contour, noise is not. 0 below seven
/// points.
double noisePx(const Polyline& contour);

/// One highlight that a fit used, as a measure of what the fit may leave of it.
struct UsedContour {
  double radius = 0, noise = 0;  ///< px
  /// Units of ModelFit::residualPx in a pixel of the photograph; canonical contours are larger than the highlight.
  double unit = 1;
  std::string frame = {};  ///< its name: frameNameOf()
};
UsedContour usedContour(const TrainingView& view, double unit = 1);
/// The id of the view's frame; its number where no scene names it.
std::string frameNameOf(const TrainingView& view);

/// NoHighlight, "the highlight has a radius of 0.0003 px, ...", for a highlight below kLeastRadiusPx.
std::optional<Failure> tooSmall(const Polyline& contour);

/// Drops predicted highlights that are too small for an answer; the prediction fails with that reason where none is left.
void dropTooSmall(Prediction& prediction);

/// LightBehindSurface where the light lies behind the tangent plane at the brightest point of a usable training view: N.(l - w P)
/// <= 0 there, so that it could not have made this highlight. Every estimate of a light is checked like this, whichever way it
/// was found.
std::optional<Failure> lightBehind(const std::vector<TrainingView>& views, const Light& light);

/// "; 5 of 6 views could not be used, frame 3: peak off surface": how many views have a reason, and the first one's. Empty where
/// no view has one.
/// @param why  of a view: why it could not be used; nothing where it could
std::string unusedViews(const std::vector<TrainingView>& views,
                        const std::function<std::optional<Failure>(const TrainingView&)>& why);
/// The same with the failure of the view itself.
std::string unusedViews(const std::vector<TrainingView>& views);

/// TooFewViews with why the other views could not be used; other failures as they are.
Failure withUnusedViews(Failure failure, const std::vector<TrainingView>& views,
                        const std::function<std::optional<Failure>(const TrainingView&)>& why);

/// A fit that leaves more than this share of the contours' radius is no answer: its prediction may not even overlap the
/// highlight.
inline constexpr double kNoAnswerShare = 0.5;

/// The fit, judged by what it leaves of its training views. It is poor (ModelFit::poor says how much is left, and which setting
/// allows more) where that is more than `mostShare` of the contours' radius in more than a third of the views, or on the whole
/// (root of the mean square of the shares). NotConverged where it is so much by kNoAnswerShare, or `mostShare` where that is
/// larger; NotFinite where it predicts nothing in a training view. Noise of single points does not count, since every model
/// leaves it. A robust fit may ignore a smaller number of views, whatever they show. Such views, and a fit that leaves more than
/// 3 px or a twentieth of the radius, become remarks.
/// @param used    the highlights behind fit.residualPx and fit.frames, in the same order
/// @param robust  outliers had no say in this fit: the rule for the whole is left out
/// @param mostShare  of the radius, fit.most_residual
Outcome<ModelFit> explaining(ModelFit fit, const std::vector<UsedContour>& used, bool robust, double mostShare);

/// Which fits serve a purpose.
enum class PoorFits { Refuse, Take };
/// The fit; NotConverged instead of a poor one where poor ones do not serve.
Outcome<ModelFit> accepted(Outcome<ModelFit> fit, PoorFits poor);

}  // namespace glint
