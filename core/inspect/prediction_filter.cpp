// SPDX-License-Identifier: BSD-3-Clause
#include "core/inspect/prediction_filter.h"

#include <algorithm>
#include <cmath>
#include <numbers>
#include <optional>

#include "core/base/number_text.h"
#include "core/geometry/light.h"
#include "core/geometry/polyline.h"
#include "core/reflectance/lobe.h"
#include "core/surface/occlusion.h"

namespace glint {
namespace {

/// log of the radiance relative to what mirrors exactly; nothing if the fit does not tell.
std::optional<double> logBrightness(const ModelFit& fit, const PredictedHighlight& h, const Eigen::Vector3d& eye, double level) {
  if (!fit.lightEstimate) return std::nullopt;
  const SurfacePoint at = facing(h.brightest.point, eye);
  const Eigen::Vector3d toLight = fit.lightEstimate->directionFrom(at.position), toCamera = (eye - at.position).normalized();
  if (!toLight.allFinite() || !toCamera.allFinite()) return std::nullopt;
  if (const ReflectanceFit* const lobe = fit.as<ReflectanceFit>()) {
    const std::optional<LogRadiance> radiance = logRadiance(lobe->lobe, lobe->roughness.mean, at.normal, toLight, toCamera);
    return radiance ? std::optional(radiance->total()) : std::nullopt;
  }
  const std::optional<double> limit = fit.limitAngle();
  const double alpha = incidentAngle(at.normal, toLight, toCamera);
  if (!limit || !(*limit > 0) || !(*limit < std::numbers::pi / 2) || !(alpha < std::numbers::pi / 2)) return std::nullopt;
  const double share = std::tan(alpha) / std::tan(*limit);
  return std::log(level) * share * share;
}

std::optional<std::string> tooFaint(const std::optional<double>& own, const std::optional<double>& brightest, double least) {
  if (!(least > 0) || !own || !brightest) return std::nullopt;
  const double share = std::exp(*own - *brightest);
  if (share >= least) return std::nullopt;
  return formatted("weaker than predict.filter_brightness: %.2g of the brightest predicted one, of at least %.3g", share, least);
}

/// Asks for the contour's middle on the surface: a brightest point may lie beside what makes the outline.
bool shadowed(const ModelFit& fit, const PredictedHighlight& h, const Camera& camera, const Surface* surface) {
  if (!surface || !fit.lightEstimate) return false;
  const Outcome<SurfacePoint> hit = surface->firstHit(camera.ray(centroid(h.contour)));
  if (!hit) return false;
  const Eigen::Vector3d eye = camera.centreInWorld();
  const SurfacePoint at = facing(*hit, eye);
  return surface->occluded(at, occlusionTarget(*surface, at.position, *fit.lightEstimate, (eye - at.position).norm()));
}

}  // namespace

void filterPrediction(Prediction& prediction, const ModelFit& fit, const Camera& camera, const Surface* surface,
                      const Settings& settings) {
  const bool byArea = settings.flag("predict.filter_area"), byShadow = settings.flag("predict.filter_shadow");
  const double leastShare = settings.number("predict.filter_brightness");
  if (prediction.failure() || (!byArea && !byShadow && !(leastShare > 0))) return;
  const double leastArea = settings.number("detect.min_area"), level = settings.number("detect.level");
  const Eigen::Vector3d eye = camera.centreInWorld();
  std::optional<double> brightest;
  if (leastShare > 0)
    for (const PredictedHighlight& h : prediction.highlights())
      if (const std::optional<double> own = logBrightness(fit, h, eye, level); own && (!brightest || *own > *brightest))
        brightest = own;
  prediction.drop([&](const PredictedHighlight& h) -> std::optional<Failure> {
    std::optional<std::string> why;
    if (const double area = std::abs(signedArea(h.contour)); byArea && area < leastArea)
      why = formatted("smaller than the smallest highlight that detection takes: %.2g of %.3g px^2", area, leastArea);
    if (!why && leastShare > 0) why = tooFaint(logBrightness(fit, h, eye, level), brightest, leastShare);
    if (!why && byShadow && shadowed(fit, h, camera, surface)) why = "in the shadow of the object itself";
    if (!why) return std::nullopt;
    prediction.filtered.push_back({h, *why});
    return Failure{Reason::NoHighlight, "filtered: " + *why};
  });
}

}  // namespace glint
