// SPDX-License-Identifier: BSD-3-Clause
#include <algorithm>
#include <cmath>

#include "core/model/level_set_prediction.h"
#include "core/model/models.h"
#include "core/reflectance/fit.h"
#include "core/reflectance/radiance_field.h"

namespace glint {
namespace {

constexpr double kScanStepPx = 16;  // of the search for a maximum away from every mirror point

class Reflectance final : public HighlightModel {
 public:
  std::string id() const override { return "reflectance"; }
  std::string title() const override { return "Reflectance"; }
  std::string assumption() const override {
    return "The contour is a level set of a full reflectance model on the surface: wide highlights and grazing views too.";
  }
  std::string reference() const override { return "method.md section 7"; }
  bool needsLight() const override { return true; }
  bool needsCanonicalContours() const override { return false; }

  Outcome<ModelFit> fit(const FitInput& input, const Settings& settings) const override {
    if (!input.light) return input.lightFailure ? *input.lightFailure : Failure{Reason::NoLight, ""};
    if (!(input.light->limitAngle > 0)) return Failure{Reason::TooFewPoints, "no contour point on the surface"};
    ModelFit fit;
    std::vector<RadianceView> views;
    for (const TrainingView& v : input.views) {
      if (v.failure) continue;
      if (!(v.highlight.level > 0 && v.highlight.level < 1)) return Failure{Reason::NotSupported, "a contour without a level"};
      fit.frames.push_back(v.frame);
      views.push_back({v.frame, v.camera, v.surface.get(), v.highlight.contour.points, v.highlight.peak, v.highlight.level});
    }
    if (views.empty()) return Failure{Reason::TooFewViews, "need 1, have 0"};
    const double level = views.front().level;
    RadianceFitOptions options;
    options.pointsPerView = settings.integer("light.bundle_points");
    options.robustPx = settings.number("light.robust_px");
    // The width at which a Gaussian lobe falls to the level at the limit angle.
    const double roughness = std::tan(input.light->limitAngle) / std::sqrt(-std::log(level));
    std::vector<Lobe> lobes;
    if (const std::string& name = settings.text("fit.lobe"); name != "auto")
      lobes = {*lobeOf(name)};
    else
      lobes = {Lobe::TorranceSparrow, Lobe::Ggx, Lobe::BlinnPhong, Lobe::Phong};
    std::optional<RadianceFit> best;
    std::optional<Failure> failure;
    // Other starts are many fits: only where no lobe explains the contours from the first guess.
    for (const bool otherStarts : {false, true}) {
      options.otherStarts = otherStarts;
      for (const Lobe lobe : lobes) {
        const Outcome<RadianceFit> f = fitRadiance(lobe, views, input.light->light, roughness, options);
        if (!f) {
          if (!failure) failure = f.failure();
        } else if (!best || f->cost < best->cost) {
          best = *f;
        }
      }
      if (best && !best->poor) break;
    }
    if (!best) return *failure;
    fit.lightEstimate = best->light;
    if (!best->light.atInfinity() && best->positionCovariance.allFinite()) fit.lightCovariance = best->positionCovariance;
    fit.roughness = best->roughness;
    fit.lobe = nameOf(best->lobe);
    fit.level = level;
    fit.residualPx = best->residualPx;
    fit.solver = "contours";
    fit.condition = input.light->condition;
    return fit;
  }

  Prediction predict(const ModelFit& fit, const Camera& camera, const Surface* surface, const Settings& settings) const override {
    Prediction p;
    if (!surface || !fit.lightEstimate || !fit.roughness || !fit.lobe || !fit.level) {
      p.failure = Failure{surface ? Reason::NoLight : Reason::NoSurface, ""};
      return p;
    }
    const Light& light = *fit.lightEstimate;
    const RadianceField radiance(*surface, camera, *lobeOf(*fit.lobe), *fit.roughness, light);
    const auto mirrorPoints = brightestPointsFor(*surface, camera, light, settings);
    std::vector<Pixel> starts;
    if (mirrorPoints)
      for (const BrightestPoint& b : *mirrorPoints) starts.push_back(b.pixel);
    const std::vector<RadiancePeak> peaks = radiance.peaks(starts, kScanStepPx);
    if (peaks.empty()) {
      p.failure = mirrorPoints ? Failure{Reason::NoBrightestPoint, "nothing in the image is lit"} : mirrorPoints.failure();
      return p;
    }
    SurfaceField field;
    const double contour = peaks.front().logRadiance + std::log(*fit.level);
    field.value = [&, contour](const SurfacePoint& at) -> std::optional<double> {
      const std::optional<double> log = radiance.at(at, contour);  // a shadow matters inside the highlight only
      return log ? std::optional<double>(-*log) : std::nullopt;
    };
    field.level = -contour;
    const Eigen::Vector3d eye = camera.centreInWorld();
    for (const RadiancePeak& k : peaks) {
      const double alpha =
          incidentAngle(k.point.normal, light.directionFrom(k.point.position), (eye - k.point.position).normalized());
      field.peaks.push_back({BrightestPoint{k.point, k.pixel, alpha}, -k.logRadiance});
    }
    return predictLevelSet(field, camera, *surface, settings);
  }
};

}  // namespace

std::unique_ptr<HighlightModel> makeReflectance() { return std::make_unique<Reflectance>(); }

}  // namespace glint
