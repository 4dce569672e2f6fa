// SPDX-License-Identifier: BSD-3-Clause
#include "core/model/plausible.h"

#include <algorithm>
#include <cmath>
#include <numbers>

#include "core/base/number_text.h"
#include "core/base/numeric.h"

namespace glint {
namespace {

constexpr double kRemarkPx = 3, kRemarkShare = 0.05;  // more than any detection leaves, and more than any highlight hides
constexpr double kNoiseShare = 1.2;                   // of the noise's sigma: what a right model leaves of it, with some reserve

std::string figure(double v) { return formatted("%.3g", v); }

}  // namespace

double radiusPx(const Polyline& contour) { return std::sqrt(std::abs(signedArea(contour)) / std::numbers::pi); }

double noisePx(const Polyline& contour) {
  const std::size_t n = contour.points.size();
  if (n < 7) return 0;
  Pixel middle(0, 0);
  for (const Pixel& p : contour.points) middle += p / double(n);
  std::vector<double> differences;
  const auto distance = [&](std::size_t i) { return (contour.points[i % n] - middle).norm(); };
  for (std::size_t i = 0; i < n; ++i) differences.push_back(std::abs(distance(i) - 2 * distance(i + 1) + distance(i + 2)));
  return 1.4826 * upperMedian(differences) / std::sqrt(6.0);  // 1 - 2 1: variance 6 of that of a point
}

UsedContour usedContour(const TrainingView& view, double unit) {
  return {radiusPx(view.highlight.contour), noisePx(view.highlight.contour), unit, frameNameOf(view)};
}

std::string frameNameOf(const TrainingView& view) { return view.frameId.empty() ? std::to_string(view.frame) : view.frameId; }

std::optional<Failure> tooSmall(const Polyline& contour) {
  const double radius = radiusPx(contour);
  if (radius >= kLeastRadiusPx) return std::nullopt;
  return Failure{Reason::NoHighlight, "the highlight has a radius of " + figure(radius) + " px; below " + figure(kLeastRadiusPx) +
                                          " px its contour cannot be detected to a tenth of the radius"};
}

void dropTooSmall(Prediction& prediction) {
  prediction.drop([](const PredictedHighlight& h) { return tooSmall(h.contour); });
}

std::optional<Failure> lightBehind(const std::vector<TrainingView>& views, const Light& light) {
  int behind = 0, usable = 0;
  std::string first;
  for (const TrainingView& v : views) {
    if (!v.seen) continue;
    ++usable;
    const SurfacePoint p = facing(v.seen->brightest.point, v.camera.centreInWorld());
    if (p.normal.dot(light.directionFrom(p.position)) > 0) continue;
    if (behind++ == 0) first = frameNameOf(v);
  }
  if (behind == 0) return std::nullopt;
  return Failure{Reason::LightBehindSurface, "the best-fitting light lies behind the surface at " + std::to_string(behind) +
                                                 " of " + std::to_string(usable) + " training highlights, first in frame " +
                                                 first};
}

std::string unusedViews(const std::vector<TrainingView>& views,
                        const std::function<std::optional<Failure>(const TrainingView&)>& why) {
  int unused = 0;
  std::string first;
  for (const TrainingView& v : views)
    if (const std::optional<Failure> reason = why(v); reason && unused++ == 0)
      first = "frame " + frameNameOf(v) + ": " + reason->message();
  if (unused == 0) return "";
  return "; " + std::to_string(unused) + " of " + std::to_string(views.size()) + " views could not be used, " + first;
}

std::string unusedViews(const std::vector<TrainingView>& views) {
  return unusedViews(views, [](const TrainingView& v) { return v.failure(); });
}

Failure withUnusedViews(Failure failure, const std::vector<TrainingView>& views,
                        const std::function<std::optional<Failure>(const TrainingView&)>& why) {
  if (failure.reason == Reason::TooFewViews) failure.detail += unusedViews(views, why);
  return failure;
}

namespace {

/// What a fit leaves of its training views.
struct Left {
  std::vector<double> px, shares;              ///< per view, without the noise of single points; of the radius
  double residual = 0, share = 0, radius = 0;  ///< root mean squares; mean

  std::vector<std::size_t> over(double limit) const {
    std::vector<std::size_t> views;
    for (std::size_t i = 0; i < shares.size(); ++i)
      if (!(shares[i] <= limit)) views.push_back(i);
    return views;
  }
  /// "2.3 px remain ...: over the limit of 10 % in 3 of 6 views" where that is so.
  std::optional<std::string> tooMuch(double limit, bool robust) const {
    const std::size_t views = over(limit).size();
    const bool inViews = 3 * views > shares.size();
    if (!inViews && (robust || share <= limit)) return std::nullopt;
    const std::string where = inViews ? " in " + std::to_string(views) + " of " + std::to_string(shares.size()) + " views" : "";
    return text() + ": over the limit of " + figure(100 * limit) + " %" + where;
  }
  std::string text() const {
    return figure(residual) + " px remain in the training views, " + figure(100 * share) + " % of the contours' radius (" +
           figure(radius) + " px)";
  }
};

Left leftOf(const ModelFit& fit, const std::vector<UsedContour>& used) {
  const double n = double(used.size());
  double shares = 0, squares = 0;
  Left left;
  for (std::size_t i = 0; i < used.size(); ++i) {
    const double residual = fit.residualPx[i] / used[i].unit, noise = kNoiseShare * used[i].noise;
    left.px.push_back(std::sqrt(std::max(0.0, residual * residual - noise * noise)));
    left.shares.push_back(left.px[i] / used[i].radius);
    shares += left.shares[i] * left.shares[i] / n;
    squares += left.px[i] * left.px[i] / n;
    left.radius += used[i].radius / n;
  }
  left.share = std::sqrt(shares);
  left.residual = std::sqrt(squares);
  return left;
}

}  // namespace

Outcome<ModelFit> explaining(ModelFit fit, const std::vector<UsedContour>& used, bool robust, double mostShare) {
  require(used.size() == fit.residualPx.size() && used.size() == fit.frames.size(), "explaining: one contour for every view");
  if (used.empty()) return fit;
  const auto name = [&](std::size_t i) { return used[i].frame.empty() ? std::to_string(fit.frames[i]) : used[i].frame; };
  for (std::size_t i = 0; i < used.size(); ++i)
    if (!std::isfinite(fit.residualPx[i] / used[i].unit))
      return Failure{Reason::NotFinite, "the fit predicts no highlight in training frame " + name(i)};
  const Left left = leftOf(fit, used);
  if (const std::optional<std::string> none = left.tooMuch(std::max(kNoAnswerShare, mostShare), robust))
    return Failure{Reason::NotConverged, *none + ", beyond which a fit is no answer"};
  if (const std::optional<std::string> poor = left.tooMuch(mostShare, robust)) {
    if (fit.poor.empty()) fit.poor = *poor + " (setting fit.most_residual)";
    return fit;
  }
  const std::vector<std::size_t> inconsistent = left.over(mostShare);
  for (const std::size_t i : inconsistent)
    fit.remarks.push_back("frame " + name(i) + " is inconsistent with the other training views: " + figure(left.px[i]) +
                          " px remain of a contour of " + figure(used[i].radius) + " px radius");
  if (inconsistent.empty() && (left.residual > kRemarkPx || left.share > kRemarkShare))
    fit.remarks.push_back("the fit explains its training views poorly: " + left.text());
  return fit;
}

Outcome<ModelFit> accepted(Outcome<ModelFit> fit, PoorFits poor) {
  if (fit && !fit->poor.empty() && poor == PoorFits::Refuse) return Failure{Reason::NotConverged, fit->poor};
  return fit;
}

}  // namespace glint
