// SPDX-License-Identifier: BSD-3-Clause
#include "core/model/pixel_evidence.h"

#include <algorithm>
#include <cmath>
#include <cstdio>

#include "core/light/estimate.h"
#include "core/model/models.h"

namespace glint {
namespace {

constexpr int kAnglePoints = 36;  // of a contour, for the first guess of the roughness

/// The mean direction of the reflected peak rays, which no noise turns behind the surface.
std::optional<Light> meanRay(const std::vector<TrainingView>& views) {
  Eigen::Vector3d mean = Eigen::Vector3d::Zero();
  double count = 0;
  for (const TrainingView& v : views) {
    if (v.failure || !v.brightest) continue;
    mean += reflectedRay(*v.brightest, v.camera).direction;
    count += 1;
  }
  // Directions that cancel have no mean: 1e-6 is far above round-off.
  return mean.norm() > 1e-6 * count ? std::optional<Light>(Light::towards(mean)) : std::nullopt;
}

}  // namespace

bool havePixels(const std::vector<TrainingView>& views) {
  bool any = false;
  for (const TrainingView& v : views) {
    if (v.failure) continue;
    if (!v.pixels) return false;
    any = true;
  }
  return any;
}

Outcome<PixelFit> fitViewsPixels(const std::vector<TrainingView>& views, const std::optional<LightEstimate>& light,
                                 const Settings& settings) {
  std::vector<const PixelPatch*> patches;
  double level = 0.5;
  for (const TrainingView& v : views) {
    if (v.failure || !v.pixels) continue;
    patches.push_back(v.pixels.get());
    level = v.highlight.level;
  }
  if (patches.empty()) return Failure{Reason::TooFewViews, "no training view has pixels"};
  std::vector<Lobe> lobes{Lobe::TorranceSparrow, Lobe::Ggx, Lobe::BlinnPhong, Lobe::Phong};
  if (const std::string& name = settings.text("fit.lobe"); name != "auto") lobes = {*lobeOf(name)};
  PixelFitOptions options;
  options.lightSize = settings.text("fit.light_size") != "point";
  std::vector<Light> starts;
  if (light) starts.push_back(light->light);
  if (const std::optional<Light> mean = meanRay(views)) starts.push_back(*mean);
  Outcome<PixelFit> best = Failure{Reason::NoLight, "no reflected ray to start from"};
  for (const Light& start : starts) {
    const double alpha = medianContourAngle(views, start, kAnglePoints);
    if (!(alpha > 0)) continue;
    const double roughness = std::clamp(std::tan(alpha) / std::sqrt(-std::log(level)), 1e-3, 1.0);  // a start within the lobes' range
    Outcome<PixelFit> fit = fitPixels(lobes, patches, start, roughness, options);
    if (!best || (fit && (fit->poor != best->poor ? best->poor : fit->cost < best->cost))) best = std::move(fit);
    if (best && !best->poor) break;
  }
  if (best && best->poor) {
    char detail[120];
    std::snprintf(detail, sizeof detail, "no lobe and light explain the pixels: %.3g px remain at the contours", best->rmsPx);
    return Failure{Reason::NotConverged, detail};
  }
  return best;
}

Outcome<ModelFit> reflectanceFromPixels(const FitInput& input, const Settings& settings) {
  if (!havePixels(input.views)) return Failure{Reason::NotSupported, "not every training view has pixels"};
  const Outcome<PixelFit> known =
      input.pixelFit ? Outcome<PixelFit>(*input.pixelFit) : fitViewsPixels(input.views, input.light, settings);
  if (!known) return known.failure();
  const PixelFit& pixels = *known;
  ModelFit fit;
  for (const TrainingView& v : input.views) {
    if (v.failure) continue;
    fit.frames.push_back(v.frame);
    fit.level = v.highlight.level;
  }
  fit.lightEstimate = pixels.model.light;
  if (!pixels.model.light.atInfinity() && pixels.positionCovariance.allFinite()) fit.lightCovariance = pixels.positionCovariance;
  fit.roughness = pixels.model.roughness;
  if (pixels.model.lightRadius > 0) fit.lightRadius = pixels.model.lightRadius;
  fit.lobe = nameOf(pixels.model.lobe);
  fit.blurPx = pixels.model.blurPx;
  fit.residualPx = pixels.residualPx;
  fit.uncertainty = pixels.uncertainty;
  fit.evidence = "pixels";
  fit.solver = "pixels";
  if (input.light) fit.condition = input.light->condition;
  return fit;
}

}  // namespace glint
