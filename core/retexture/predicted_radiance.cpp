// SPDX-License-Identifier: BSD-3-Clause
#include "core/retexture/predicted_radiance.h"

#include <algorithm>
#include <cmath>
#include <opencv2/imgproc.hpp>

#include "core/base/number_text.h"
#include "core/base/words.h"
#include "core/model/reflectance_settings.h"
#include "core/reflectance/radiance_field.h"
#include "core/retexture/pixels.h"
#include "core/surface/occlusion.h"

namespace glint {
namespace {

constexpr double kLeastBlurPx = 0.3;      // a narrower blur than the pixel itself changes nothing that can be seen
constexpr double kDarkest = 14;           // log I below the strongest: a millionth, far below one code of 16 bits
constexpr double kLeastShare = 1e-6;      // the same for profiles: no shadow ray is worth less
constexpr double kLeastCoverage = 0.999;  // of directions: from here on a contour counts as whole

/// One light's highlight in a frame as a function of the pixel: share of the strength, and whether it is extrapolated.
struct Share {
  double value = 0;
  bool extrapolated = false;
};
using ShareAt = std::function<Share(const Pixel& ideal)>;

/// Calls `share` for every measured pixel of the camera and adds `strength` times it.
void addTo(PredictedRadiance& sum, const Camera& camera, const ShareAt& share, const Eigen::Vector3d& strength, double blurPx,
           const ProgressFn& progress) {
  Image one(camera.width, camera.height, 1);
  forEachPixel(
      camera,
      [&](std::size_t i, const Pixel& ideal) {
        const Share s = share(ideal);
        if (!std::isfinite(s.value) || s.value <= 0) return;
        one.data[i] = float(s.value);
        if (s.extrapolated) sum.extrapolated[i] = 1;
      },
      progress, "highlight");
  if (blurPx > kLeastBlurPx) {
    cv::Mat view(one.height, one.width, CV_32FC1, one.data.data());
    cv::GaussianBlur(view, view, cv::Size(), blurPx, blurPx, cv::BORDER_REPLICATE);
  }
  for (std::size_t i = 0; i < one.data.size(); ++i)
    for (std::size_t c = 0; c < 3; ++c) sum.radiance.data[3 * i + c] += float(strength(Eigen::Index(c))) * one.data[i];
}

bool inShadow(const Surface& surface, const SurfacePoint& p, const Light& light, const Eigen::Vector3d& eye) {
  return surface.occluded(p, occlusionTarget(surface, p.position, light, (eye - p.position).norm()));
}

/// rho of the nearest of the predicted contours; each knows its gaps.
ShareAt contourShare(std::vector<ContourStar> stars, const FallProfile& profile, std::shared_ptr<const Surface> surface,
                     const Camera& camera) {
  return [stars = std::move(stars), &profile, surface = std::move(surface), &camera](const Pixel& ideal) -> Share {
    const ContourStar* nearest = nullptr;
    double rho = FallProfile::kEnd;
    for (const ContourStar& star : stars)
      if (const double r = star.rho(ideal); r < rho) rho = r, nearest = &star;
    if (!nearest || (surface && !surface->firstHit(camera.ray(ideal)))) return {};
    return {profile.at(rho), nearest->inGap(ideal) || rho < profile.observedFrom()};
  };
}

ShareAt angleShare(const LimitAngleFit& fit, const Light& light, const FallProfile& profile,
                   std::shared_ptr<const Surface> surface, const Camera& camera) {
  return
      [&fit, &light, &profile, surface = std::move(surface), &camera, eye = camera.centreInWorld()](const Pixel& ideal) -> Share {
        const Outcome<SurfacePoint> hit = surface->firstHit(camera.ray(ideal));
        if (!hit) return {};
        const SurfacePoint p = facing(*hit, eye);
        const std::optional<double> rho = angleRho(fit, light, p, eye);
        const double share = rho ? profile.at(*rho) : 0;
        if (share < kLeastShare || inShadow(*surface, p, light, eye)) return {};
        return {share, *rho < profile.observedFrom()};
      };
}

/// The highlight of one light, whose prediction has contours.
std::optional<Failure> addLight(const Inspection& in, int frame, const FrameComparison& predicted, const ModelFit& fit,
                                const HighlightAppearance& a, PredictedRadiance& sum, const ProgressFn& progress) {
  const Camera camera = in.cameraFor(frame, predicted.light);
  const Outcome<std::shared_ptr<const Surface>> surface = surfaceFor(in, frame, predicted.light);
  if (a.kind != HighlightAppearance::Kind::Contour && !surface) return surface.failure();
  if (a.kind == HighlightAppearance::Kind::Lobe) {
    const ReflectanceFit& lobe = *fit.as<ReflectanceFit>();
    const RadianceField field(**surface, camera, lobe.lobe, lobe.roughness, *fit.lamp());
    const ShareAt share = [&](const Pixel& ideal) -> Share {
      const Outcome<SurfacePoint> hit = (*surface)->firstHit(camera.ray(ideal));
      if (!hit) return {};
      const std::optional<double> log = field.at(facing(*hit, camera.centreInWorld()), a.logReference - kDarkest);
      return {log && *log > a.logReference - kDarkest ? std::exp(*log - a.logReference) : 0.0, false};
    };
    addTo(sum, camera, share, a.strength, lobe.blurPx.value_or(0), progress);
    return std::nullopt;
  }
  if (a.kind == HighlightAppearance::Kind::Angle) {
    addTo(sum, camera, angleShare(*fit.as<LimitAngleFit>(), *fit.lightEstimate, *a.profile, *surface, camera), a.strength, 0,
          progress);
    return std::nullopt;
  }
  std::vector<ContourStar> stars;
  std::optional<Failure> why;
  for (const PredictedHighlight& h : predicted.prediction.highlights()) {
    const Outcome<ContourStar> star = ContourStar::of(h.contour, h.brightest.pixel, h.gaps);
    if (star)
      stars.push_back(*star);
    else
      why = star.failure();
  }
  if (stars.empty()) return why;
  addTo(sum, camera, contourShare(std::move(stars), *a.profile, surface ? *surface : nullptr, camera), a.strength, 0, progress);
  return std::nullopt;
}

void addContours(const FrameComparison& c, PredictedRadiance& sum) {
  for (const PredictedHighlight& h : c.prediction.highlights()) {
    sum.contours.push_back(h.contour);
    sum.coverage.push_back(h.coverage);
    if (h.coverage < kLeastCoverage)
      sum.remarks.push_back(
          formatted("%s: %.0f %% of the contour's directions were not predicted; there the highlight's edge is "
                    "bridged",
                    lightName(c.light).c_str(), 100 * (1 - h.coverage)));
  }
}

}  // namespace

Outcome<PredictedRadiance> predictedRadiance(const Inspection& in, int frame, const std::string& model, const std::string& light,
                                             const ProgressFn& progress, LearnedAppearances* known) {
  require(in.scene && frame >= 0 && frame < int(in.scene->frames.size()), "predictedRadiance: no such frame");
  const auto result = in.models.find(model);
  require(result != in.models.end(), "predictedRadiance: no such model");
  const Camera& camera = in.scene->frames[std::size_t(frame)].camera;
  PredictedRadiance sum;
  sum.radiance = Image(camera.width, camera.height, 3);
  sum.extrapolated.assign(std::size_t(camera.width) * std::size_t(camera.height), 0);
  std::optional<Failure> why;
  const auto missing = [&](const std::string& id, const Failure& failure) {
    if (!why) why = Failure{failure.reason, lightName(id) + (failure.detail.empty() ? "" : ": " + failure.detail)};
    sum.remarks.push_back(lightName(id) + " is not in the picture: " + failure.message());
  };
  for (const FrameComparison& c : result->second.frames) {
    if (c.frame != frame || (!light.empty() && c.light != light)) continue;
    if (const Failure* const failure = c.prediction.failure()) {
      missing(c.light, *failure);
      continue;
    }
    const auto& fits = result->second.fits;
    if (c.fit < 0 || c.fit >= int(fits.size()) || !fits[std::size_t(c.fit)].fit) {
      missing(c.light, Failure{Reason::NotReached, "the model has no fit of it"});
      continue;
    }
    const ModelResult::Fit& fit = fits[std::size_t(c.fit)];
    Outcome<HighlightAppearance> appearance = known ? known->of(in, model, fit) : learnAppearance(in, *fit.fit, fit.key());
    std::optional<Failure> failed =
        appearance ? addLight(in, frame, c, *fit.fit, *appearance, sum, progress) : appearance.failure();
    if (failed) {
      missing(c.light, *failed);
      continue;
    }
    addContours(c, sum);
    for (const std::string& r : appearance->remarks) sum.remarks.push_back(lightName(c.light) + ": " + r);
    sum.lights.push_back({c.light, *std::move(appearance)});
  }
  if (!sum.lights.empty()) return sum;
  const std::string& id = in.scene->frames[std::size_t(frame)].id;
  if (!why)
    return Failure{Reason::NotSupported,
                   "frame " + id + " has no prediction of " + (light.empty() ? "any light" : lightName(light))};
  return *why;
}

}  // namespace glint
