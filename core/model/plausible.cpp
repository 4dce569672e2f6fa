// SPDX-License-Identifier: BSD-3-Clause
#include "core/model/plausible.h"

#include <algorithm>
#include <cmath>
#include <numbers>

#include "core/base/median.h"
#include "core/base/number_text.h"

namespace glint {
namespace {

constexpr double kRemarkPx = 3, kRemarkShare = 0.05;  // what no detection leaves, and what no highlight hides
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
  return {radiusPx(view.highlight.contour), noisePx(view.highlight.contour), unit};
}

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
  int behind = 0, usable = 0, first = -1;
  for (const TrainingView& v : views) {
    if (!v.seen) continue;
    ++usable;
    const SurfacePoint p = facing(v.seen->brightest.point, v.camera.centreInWorld());
    if (p.normal.dot(light.directionFrom(p.position)) > 0) continue;
    if (behind++ == 0) first = v.frame;
  }
  if (behind == 0) return std::nullopt;
  return Failure{Reason::LightBehindSurface, "the best-fitting light lies behind the surface at " + std::to_string(behind) +
                                                 " of " + std::to_string(usable) + " training highlights, first in frame " +
                                                 std::to_string(first)};
}

std::string unusedViews(const std::vector<TrainingView>& views,
                        const std::function<std::optional<Failure>(const TrainingView&)>& why) {
  int unused = 0;
  std::string first;
  for (const TrainingView& v : views)
    if (const std::optional<Failure> reason = why(v); reason && unused++ == 0)
      first = "frame " + std::to_string(v.frame) + ": " + reason->message();
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

Outcome<ModelFit> explaining(ModelFit fit, const std::vector<UsedContour>& used, bool robust, double mostShare) {
  require(used.size() == fit.residualPx.size() && used.size() == fit.frames.size(), "explaining: one contour for every view");
  if (used.empty()) return fit;
  const double n = double(used.size());
  double shares = 0, squares = 0, radius = 0;
  std::vector<double> left;  // px of the photograph, without the noise
  std::vector<std::size_t> poor;
  for (std::size_t i = 0; i < used.size(); ++i) {
    const double residual = fit.residualPx[i] / used[i].unit, noise = kNoiseShare * used[i].noise;
    if (!std::isfinite(residual))
      return Failure{Reason::NotFinite, "the fit predicts no highlight in training frame " + std::to_string(fit.frames[i])};
    left.push_back(std::sqrt(std::max(0.0, residual * residual - noise * noise)));
    const double share = left[i] / used[i].radius;
    shares += share * share / n;
    squares += left[i] * left[i] / n;
    radius += used[i].radius / n;
    if (!(share <= mostShare)) poor.push_back(i);
  }
  const double share = std::sqrt(shares), residual = std::sqrt(squares);
  const std::string text = figure(residual) + " px remain in the training views, " + figure(100 * share) +
                           " % of the contours' radius (" + figure(radius) + " px)";
  const bool poorViews = 3 * poor.size() > used.size();
  if (poorViews || (!robust && !(share <= mostShare))) {
    const std::string where =
        poorViews ? " in " + std::to_string(poor.size()) + " of " + std::to_string(used.size()) + " views" : "";
    return Failure{Reason::NotConverged,
                   text + ": over the limit of " + figure(100 * mostShare) + " %" + where + " (setting fit.most_residual)"};
  }
  for (const std::size_t i : poor)
    fit.remarks.push_back("frame " + std::to_string(fit.frames[i]) + " is inconsistent with the other training views: " +
                          figure(left[i]) + " px remain of a contour of " + figure(used[i].radius) + " px radius");
  if (poor.empty() && (residual > kRemarkPx || share > kRemarkShare))
    fit.remarks.push_back("the fit explains its training views poorly: " + text);
  return fit;
}

}  // namespace glint
