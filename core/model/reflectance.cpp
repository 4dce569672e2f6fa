// SPDX-License-Identifier: BSD-3-Clause
#include <algorithm>
#include <cmath>
#include <cstdio>

#include "core/light/estimate.h"
#include "core/model/level_set_prediction.h"
#include "core/model/models.h"
#include "core/model/uncertainty.h"
#include "core/reflectance/fit.h"
#include "core/reflectance/light_radiance.h"
#include "core/reflectance/radiance_field.h"

namespace glint {
namespace {

constexpr int kAnglePoints = 36;    // of a contour, for the first guess of the roughness
constexpr double kScanStepPx = 16;  // of the search for a maximum away from every mirror point
// log of an 8-bit picture's range: a lobe that has fallen further shows nothing beside the highlights of other frames.
constexpr double kFaintest = 5.54;
// Of the sum of squares over their mean: three standard deviations, before a cosine power is preferred to a microfacet lobe.
constexpr double kClearGain = 9;
constexpr std::size_t kPromisingStarts = 6;  // of those that a short fit to few points likes best

/// Where the search starts: the light of the limit angle; where that model does not converge (wide lobes, grazing views), the
/// closest point to the reflected peak rays, or their mean direction.
std::optional<Light> firstLight(const FitInput& input) {
  if (input.light) return input.light->light;
  std::vector<ReflectedRay> rays;
  Eigen::Vector3d mean = Eigen::Vector3d::Zero();
  for (const TrainingView& v : input.views) {
    if (v.failure || !v.brightest) continue;
    rays.push_back(reflectedRay(*v.brightest, v.camera));
    mean += rays.back().direction;
  }
  if (const Outcome<Triangulation> t = triangulateLight(rays)) return t->light;
  // Directions that cancel have no mean.
  return mean.norm() > 1e-6 * double(rays.size()) ? std::optional<Light>(Light::towards(mean)) : std::nullopt;
}

/// The lobe of the smallest residual; each starts from the best one so far. Where none explains the contours well, the most
/// promising starts of all lobes are tried, and the lobes follow the best of them. Where the residuals do not tell, a microfacet
/// lobe.
Outcome<RadianceFit> bestOf(const std::vector<Lobe>& lobes, const std::vector<RadianceView>& views, const Light& light,
                            double roughness, RadianceFitOptions options) {
  Outcome<RadianceFit> best = Failure{Reason::NotConverged, ""}, microfacet = best;
  const bool lightSize = options.lightSize;
  options.lightSize = options.otherStarts = false;
  const auto tryFrom = [&](Lobe lobe, const Light& from, double width) {
    Outcome<RadianceFit> f = fitRadiance(lobe, views, from, width, options);
    const auto improve = [&](Outcome<RadianceFit>& on) {
      if (!on || (f && (f->poor != on->poor ? on->poor : f->cost < on->cost))) on = f;
    };
    improve(best);
    if (lobe == Lobe::TorranceSparrow || lobe == Lobe::Ggx) improve(microfacet);
  };
  const auto tryAll = [&] {
    for (const Lobe lobe : lobes) {
      const bool follow = best && !best->poor;
      const Light from = follow ? best->light : light;
      tryFrom(lobe, from, follow ? best->roughness : roughness);
    }
  };
  tryAll();
  if (!best || best->doubtful) {
    std::vector<RadianceStart> starts;
    for (const Lobe lobe : lobes)
      for (const RadianceStart& s : screenStarts(lobe, views, light, roughness, options)) starts.push_back(s);
    std::stable_sort(starts.begin(), starts.end(),
                     [](const RadianceStart& a, const RadianceStart& b) { return a.cost < b.cost; });
    bool better = false;
    for (std::size_t i = 0; i < starts.size() && i < kPromisingStarts && !(best && !best->doubtful); ++i) {
      const double before = best ? best->cost : std::numeric_limits<double>::infinity();
      tryFrom(starts[i].lobe, starts[i].light, starts[i].roughness);
      better = better || (best && best->cost < before);
    }
    if (better && lobes.size() > 1 && !best->poor) tryAll();
  }
  // Surfaces are rather microfacets than cosine powers: where noise leaves the choice open, a microfacet lobe is taken.
  if (best && microfacet && !microfacet->poor && microfacet->cost - best->cost < kClearGain * best->cost / best->points)
    best = microfacet;
  if (!best || best->poor || !lightSize) return best;
  // A size is tried on the best lobe; only where it shows are the others tried with one too.
  options.lightSize = true;
  const RadianceFit point = *best;
  const auto withSize = [&](Lobe lobe) {
    Outcome<RadianceFit> f = fitRadiance(lobe, views, point.light, point.roughness, options);
    if (f && f->cost < best->cost) best = std::move(f);
  };
  withSize(point.lobe);
  if (best->lightRadius > 0)
    for (const Lobe lobe : lobes)
      if (lobe != point.lobe) withSize(lobe);
  return best;
}

/// -log I; `contour` is log I on the contour: a shadow matters inside the highlight only.
std::function<std::optional<double>(const SurfacePoint&)> valueOf(const RadianceField& radiance, double contour) {
  return [&radiance, contour](const SurfacePoint& at) -> std::optional<double> {
    const std::optional<double> log = radiance.at(at, contour);
    return log ? std::optional<double>(-*log) : std::nullopt;
  };
}

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
    options.lightSize = settings.text("fit.light_size") == "auto";
    const std::optional<Light> light = firstLight(input);
    if (!light) return input.lightFailure ? *input.lightFailure : Failure{Reason::NoLight, ""};
    const double alpha = medianContourAngle(input.views, *light, kAnglePoints);
    if (!(alpha > 0)) return Failure{Reason::PeakOffSurface, "no contour point hits the lit surface"};
    // The width at which a Gaussian lobe falls to the level at that angle.
    const double roughness = std::clamp(std::tan(alpha) / std::sqrt(-std::log(level)), 1e-4, 1.0);
    std::vector<Lobe> lobes{Lobe::TorranceSparrow, Lobe::Ggx, Lobe::BlinnPhong, Lobe::Phong};
    const std::string& name = settings.text("fit.lobe");
    if (name != "auto") lobes = {*lobeOf(name)};
    Outcome<RadianceFit> best = bestOf(lobes, views, *light, roughness, options);
    if (name != "auto" && (!best || best->poor)) {
      // Another lobe may find the way from the first guess; from its light the lobe asked for starts close.
      const Lobe other = lobes[0] == Lobe::TorranceSparrow ? Lobe::BlinnPhong : Lobe::TorranceSparrow;
      if (const Outcome<RadianceFit> guide = bestOf({other}, views, *light, roughness, options); guide && !guide->poor)
        if (Outcome<RadianceFit> again = bestOf(lobes, views, guide->light, guide->roughness, options); again && !again->poor)
          best = std::move(again);
    }
    if (!best) return best.failure();
    if (best->poor) {
      char detail[80];
      std::snprintf(detail, sizeof detail, "no light and roughness explain the contours: %.3g px remain", best->rmsPx);
      return Failure{Reason::NotConverged, detail};
    }
    fit.lightEstimate = best->light;
    if (!best->light.atInfinity() && best->positionCovariance.allFinite()) fit.lightCovariance = best->positionCovariance;
    fit.roughness = best->roughness;
    if (best->lightRadius > 0) fit.lightRadius = best->lightRadius;
    fit.lobe = nameOf(best->lobe);
    fit.level = level;
    fit.residualPx = best->residualPx;
    fit.uncertainty = best->uncertainty;
    fit.solver = "contours";
    if (input.light) fit.condition = input.light->condition;
    return fit;
  }

  std::vector<double> bandSigmaPx(const ModelFit& fit, const PredictedHighlight& highlight, const Camera& camera,
                                  const Surface* surface, const Settings&) const override {
    if (!surface || !fit.uncertainty || !fit.lightEstimate || !fit.roughness || !fit.lobe || !fit.level) return {};
    const Light& light = *fit.lightEstimate;
    const double radius = fit.lightRadius.value_or(0);
    const RadianceField radiance(*surface, camera, *lobeOf(*fit.lobe), *fit.roughness, light, radius);
    const std::vector<RadiancePeak> peaks = radiance.peaks({highlight.brightest.pixel}, kScanStepPx);
    if (peaks.empty()) return {};
    const double contour = peaks.front().logRadiance + std::log(*fit.level);
    SurfaceField field;
    field.value = valueOf(radiance, contour);
    field.level = -contour;
    const Eigen::Vector3d eye = camera.centreInWorld();
    const Eigen::MatrixXd& root = fit.uncertainty->root;
    // log I(peak) - log I(point) with the parameters moved. The peak stays: its value does not change with its place, to first
    // order.
    const auto moved = [&](const SurfacePoint& at, const Eigen::VectorXd& by) -> double {
      const Eigen::Vector4d other = light.homogeneous() + by.head<4>();
      const auto log = [&](const SurfacePoint& p) {
        return lobe::logOfSphereLight<double>(*lobeOf(*fit.lobe), *fit.roughness * std::exp(by(4)), p.position, p.normal,
                                              (eye - p.position).normalized(), other, radius * radius, radiance.rule());
      };
      const auto here = log(at), top = log(peaks.front().point);
      return here && top ? *top - *here : std::nan("");
    };
    const ColumnSlopes slopes = [&](const SurfacePoint& at) -> std::optional<Eigen::VectorXd> {
      constexpr double kStep = 0.01;  // of a standard deviation
      Eigen::VectorXd change(root.cols());
      for (Eigen::Index k = 0; k < root.cols(); ++k)
        change(k) = (moved(at, kStep * root.col(k)) - moved(at, -kStep * root.col(k))) / (2 * kStep);
      return change;
    };
    return levelSetSigmaPx(highlight.contour.points, field, camera, *surface, slopes);
  }

  Prediction predict(const ModelFit& fit, const Camera& camera, const Surface* surface, const Settings& settings) const override {
    Prediction p;
    if (!surface || !fit.lightEstimate || !fit.roughness || !fit.lobe || !fit.level) {
      p.failure = Failure{surface ? Reason::NoLight : Reason::NoSurface, ""};
      return p;
    }
    const Light& light = *fit.lightEstimate;
    const RadianceField radiance(*surface, camera, *lobeOf(*fit.lobe), *fit.roughness, light, fit.lightRadius.value_or(0));
    const auto mirrorPoints = brightestPointsFor(*surface, camera, light, settings);
    std::vector<Pixel> starts;
    if (mirrorPoints)
      for (const BrightestPoint& b : *mirrorPoints) starts.push_back(b.pixel);
    const std::vector<RadiancePeak> peaks = radiance.peaks(starts, kScanStepPx);
    if (peaks.empty()) {
      p.failure = mirrorPoints ? Failure{Reason::NoBrightestPoint, "nothing in the image is lit"} : mirrorPoints.failure();
      return p;
    }
    if (peaks.front().cut) {
      p.failure = Failure{Reason::OutsideImage, "the radiance rises beyond the image"};
      return p;
    }
    if (const double fall = radiance.fallOfLobe(peaks.front().point); !(fall < kFaintest)) {
      p.failure = Failure{Reason::NoBrightestPoint, "no visible point is near the mirror direction of the light"};
      return p;
    }
    SurfaceField field;
    const double contour = peaks.front().logRadiance + std::log(*fit.level);
    field.value = valueOf(radiance, contour);
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
