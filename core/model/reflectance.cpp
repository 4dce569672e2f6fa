// SPDX-License-Identifier: BSD-3-Clause
#include <algorithm>
#include <cmath>
#include <cstdlib>
#include <set>
#include <sstream>

#include "core/base/number_text.h"
#include "core/light/estimate.h"
#include "core/model/level_set_prediction.h"
#include "core/model/models.h"
#include "core/model/pixel_evidence.h"
#include "core/model/plausible.h"
#include "core/model/reflectance_settings.h"
#include "core/model/star_level_set.h"
#include "core/model/uncertainty.h"
#include "core/reflectance/fit.h"
#include "core/reflectance/light_radiance.h"
#include "core/reflectance/radiance_field.h"

namespace glint {
namespace {

constexpr int kAnglePoints = 36;    // of a contour, for the first guess of the lobe's width
constexpr double kScanStepPx = 16;  // of the search for a maximum away from every mirror point
// log of an 8-bit picture's range: a lobe that has fallen further shows nothing beside the highlights of other frames.
constexpr double kFaintest = 5.54;

/// Where the search starts: the light of the limit angle; where that model does not converge (wide lobes, grazing views), the
/// closest point to the reflected peak rays, or their mean direction.
std::optional<Light> firstLight(const FitInput& input) {
  if (input.light) return input.light->light;
  std::vector<ReflectedRay> rays;
  Eigen::Vector3d mean = Eigen::Vector3d::Zero();
  for (const TrainingView& v : input.views) {
    if (!v.seen) continue;
    rays.push_back(reflectedRay(v.seen->brightest, v.camera));
    mean += rays.back().direction;
  }
  if (const Outcome<Triangulation> t = triangulateLight(rays)) return t->light;
  // Directions that cancel have no mean.
  return mean.norm() > 1e-6 * double(rays.size()) ? std::optional<Light>(Light::towards(mean)) : std::nullopt;
}

/// RMS over all contours of a training view, from the residual of each; contours of one view have about equally many points.
std::vector<double> perView(const std::vector<double>& rms, const std::vector<std::size_t>& owner, std::size_t views) {
  std::vector<double> squares(views, 0);
  std::vector<int> counts(views, 0);
  for (std::size_t i = 0; i < rms.size(); ++i) squares[owner[i]] += rms[i] * rms[i], ++counts[owner[i]];
  for (std::size_t v = 0; v < views; ++v) squares[v] = counts[v] ? std::sqrt(squares[v] / counts[v]) : 0;
  return squares;
}

bool isListed(double level, const std::vector<double>& listed) {
  constexpr double kSameLevel = 1e-6;  // levels are typed with a few digits
  return level > 0 && level < 1 &&
         std::any_of(listed.begin(), listed.end(), [&](double l) { return std::abs(l - level) < kSameLevel; });
}

/// Levels of the contours, each once, ascending.
std::vector<double> levelsOf(const std::vector<RadianceView>& views) {
  std::set<double> levels;
  for (const RadianceView& v : views) levels.insert(v.level);
  return {levels.begin(), levels.end()};
}

/// -log I. `contour` is log I on the contour: a shadow matters only inside the highlight.
std::function<std::optional<double>(const SurfacePoint&)> valueOf(const RadianceField& radiance, double contour) {
  return [&radiance, contour](const SurfacePoint& at) -> std::optional<double> {
    const std::optional<double> log = radiance.at(at, contour);
    return log ? std::optional<double>(-*log) : std::nullopt;
  };
}

/// The same as a fit of contours: lobe, roughness and lamp.
std::optional<RadianceFit> radianceFitOf(const ModelFit& fit) {
  const ReflectanceFit* const fitted = fit.as<ReflectanceFit>();
  if (!fit.lightEstimate || !fitted) return std::nullopt;
  RadianceFit result;
  result.lobe = fitted->lobe;
  result.roughness = fitted->roughness;
  result.lamp = *fit.lamp();
  return result;
}

class Reflectance final : public HighlightModel {
 public:
  std::string id() const override { return "reflectance"; }
  std::string title() const override { return "Reflectance"; }
  std::string assumption() const override {
    return "The contour is a level set of a full reflectance model on the surface. Also valid for wide highlights and grazing "
           "views.";
  }
  std::string reference() const override { return "method.md section 7"; }
  bool needsLight() const override { return true; }
  bool needsCanonicalContours() const override { return false; }
  bool takesPixels() const override { return true; }
  ModelTraits traits() const override { return {{204, 121, 167}}; }

  Outcome<ModelFit> fit(const FitInput& input, const Settings& settings) const override {
    ModelFit fit;
    std::vector<RadianceView> views;
    std::vector<std::size_t> owner;  // of each contour: which training view
    const bool severalLevels = settings.text("fit.evidence") == "levels";
    const std::vector<double> listed = listedLevels(settings);
    const auto add = [&](const TrainingView& v, double level, const Polyline& contour) {
      views.push_back({v.frame, v.camera, v.surface.get(), contour.points, v.highlight.peak, level});
      owner.push_back(fit.frames.size() - 1);
    };
    for (const TrainingView& v : input.views) {
      if (!v.seen) continue;
      if (!(v.highlight.level > 0 && v.highlight.level < 1)) return Failure{Reason::NotSupported, "a contour without a level"};
      fit.frames.push_back(v.frame);
      add(v, v.highlight.level, v.highlight.contour);
      for (const LevelContour& c : v.levels)
        if (severalLevels && isListed(c.level, listed)) add(v, c.level, c.contour);
    }
    if (views.empty()) return Failure{Reason::TooFewViews, "need 1, have 0" + unusedViews(input.views)};
    if (severalLevels && views.size() == fit.frames.size())
      fit.remarks.push_back("Fitted to one contour per highlight: no other levels are given.");
    const std::string& evidence = settings.text("fit.evidence");
    if (evidence == "pixels" || (evidence == "auto" && havePixels(input.views))) {
      Outcome<ModelFit> fromPixels = reflectanceFromPixels(input, settings);
      if (fromPixels && fromPixels->lightEstimate)
        if (const std::optional<Failure> behind = lightBehind(input.views, *fromPixels->lightEstimate)) return *behind;
      const Outcome<ModelFit> good = accepted(fromPixels, PoorFits::Refuse);
      if (good) return good;
      fit.remarks.push_back("Fitted to contours, not to pixels: " + good.failure().message() + ".");
      Outcome<ModelFit> instead = fromContours(std::move(fit), input, views, owner, settings);
      return instead || !fromPixels ? instead : fromPixels;
    }
    return fromContours(std::move(fit), input, views, owner, settings);
  }

  /// @param fit  names its frames. @param owner  of each view: which of these frames
  static Outcome<ModelFit> fromContours(ModelFit fit, const FitInput& input, const std::vector<RadianceView>& views,
                                        const std::vector<std::size_t>& owner, const Settings& settings) {
    const double level = views.front().level;
    const Outcome<RadianceFit> best = lampOfContours(input, views, settings);
    if (!best) return best.failure();
    if (best->poor) fit.poor = formatted("no light and roughness explain the contours: %.3g px remain", best->rmsPx);
    if (const std::optional<Failure> behind = lightBehind(input.views, best->light())) return *behind;
    fit.lightEstimate = best->light();
    if (!best->lamp.atInfinity() && best->positionCovariance.allFinite()) fit.lightCovariance = best->positionCovariance;
    const char* const seen = views.size() > fit.frames.size() ? "levels" : "contours";
    fit.family = ReflectanceFit{best->lobe, best->roughness, level, best->lamp.shape, seen, levelsOf(views)};
    fit.residualPx = perView(best->residualPx, owner, fit.frames.size());
    fit.uncertainty = best->uncertainty;
    fit.solver = "contours";
    if (input.light) fit.condition = input.light->condition;
    std::vector<UsedContour> used;
    for (const TrainingView& v : input.views)
      if (v.seen) used.push_back(usedContour(v));
    return explaining(std::move(fit), used, true, settings.number("fit.most_residual"));
  }

  /// Starts from the fit that is known nearby, where that leads to an explanation; else searches.
  static Outcome<RadianceFit> lampOfContours(const FitInput& input, const std::vector<RadianceView>& views,
                                             const Settings& settings) {
    RadianceFitOptions options = radianceFitOptionsOf(settings);
    options.progress = input.progress;
    if (input.light && input.light->known) return underKnownLamp(input, views, settings, options);
    if (const std::optional<RadianceFit> near = input.near ? radianceFitOf(*input.near) : std::nullopt)
      if (Outcome<RadianceFit> found = fitNear(lobesOf(settings), views, *near, options); found && !found->poor) return found;
    const std::optional<Light> light = firstLight(input);
    if (!light) return input.lightFailure ? *input.lightFailure : Failure{Reason::NoLight, ""};
    const double alpha = medianContourAngle(input.views, *light, kAnglePoints);
    if (!(alpha > 0)) return Failure{Reason::PeakOffSurface, "no contour point hits the lit surface"};
    return searchRadiance(lobesOf(settings), views, *light, std::min(alpha, kWidestStart), lampChoicesOf(settings), options);
  }

  /// The lobe alone: the lamp stays as the scene states it.
  static Outcome<RadianceFit> underKnownLamp(const FitInput& input, const std::vector<RadianceView>& views,
                                             const Settings& settings, RadianceFitOptions options) {
    const std::vector<Lobe> lobes = lobesOf(settings);
    const double alpha = medianContourAngle(input.views, input.light->light, kAnglePoints);
    if (!(alpha > 0)) return Failure{Reason::PeakOffSurface, "no contour point hits the lit surface"};
    options.holdLamp = true;
    RadianceFit start;
    start.lobe = lobes.front();
    start.roughness = std::min(std::tan(std::min(alpha, kWidestStart)) / std::sqrt(-std::log(views.front().level)), 1.0);
    start.lamp = Lamp(input.light->light.homogeneous(), *input.light->known);
    return fitNear(lobes, views, start, options);
  }

  Eigen::MatrixXd bandShiftsPx(const ModelFit& fit, const PredictedHighlight& highlight, const Camera& camera,
                               const Surface* surface, const Settings&) const override {
    const ReflectanceFit* const fitted = fit.as<ReflectanceFit>();
    if (!surface || !fit.uncertainty || !fit.lightEstimate || !fitted) return {};
    const Lamp lamp = *fit.lamp();
    const RadianceField radiance(*surface, camera, fitted->lobe, fitted->roughness, lamp);
    const std::vector<RadiancePeak> peaks = radiance.peaks({highlight.brightest.pixel}, kScanStepPx);
    if (peaks.empty()) return {};
    const double contour = peaks.front().logRadiance + std::log(fitted->level);
    SurfaceField field;
    field.value = valueOf(radiance, contour);
    field.level = -contour;
    const Eigen::Vector3d eye = camera.centreInWorld();
    const Eigen::MatrixXd& root = fit.uncertainty->root;
    // log I(peak) - log I(point) with the parameters moved. The peak stays: its value does not change with its place, to first
    // order.
    const auto moved = [&](const SurfacePoint& at, const Eigen::VectorXd& by) -> double {
      Lamp other = lamp;
      other.centre += parameters::kLight.of(by);
      std::span<double> own = unknownsOf(other.shape);
      for (std::size_t k = 0; k < own.size() && by.size() > parameters::kLampShape; ++k)
        own[k] += by(parameters::kLampShape + static_cast<Eigen::Index>(k));
      const double ratio = hasTwoWidths(fitted->lobe) ? fitted->roughness.ratio * std::exp(by(by.size() - 1)) : 1;
      const Roughness roughness{fitted->roughness.mean * std::exp(by(parameters::kLogRoughness.first)), ratio};
      const auto log = [&](const SurfacePoint& p) {
        return lobe::logOfLamp<double>(fitted->lobe, roughness, p.position, axesAt(fitted->lobe, *surface, p),
                                       (eye - p.position).normalized(), other, radiance.rule());
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
    return levelSetShiftsPx(highlight.contour.points, field, camera, *surface, slopes);
  }

  std::optional<ModelFit> atLevelOf(const ModelFit& fit, const Pixel& place, const Camera& camera, const Surface& surface,
                                    const Settings& settings) const override {
    const ReflectanceFit* const fitted = fit.as<ReflectanceFit>();
    if (!fit.lightEstimate || !fitted) return std::nullopt;
    const RadianceField radiance(surface, camera, fitted->lobe, fitted->roughness, *fit.lamp());
    std::vector<Pixel> starts{place};
    if (const auto mirrorPoints = brightestPointsFor(surface, camera, *fit.lightEstimate, settings))
      for (const BrightestPoint& b : *mirrorPoints) starts.push_back(b.pixel);
    const std::vector<RadiancePeak> peaks = radiance.peaks(starts, kScanStepPx);
    const std::optional<double> there = radiance.at(place);
    if (!there || peaks.empty() || peaks.front().cut) return std::nullopt;
    ModelFit other = fit;
    std::get<ReflectanceFit>(other.family).level *= std::exp(std::min(0.0, *there - peaks.front().logRadiance));
    return other;
  }

  Prediction predict(const ModelFit& fit, const Camera& camera, const Surface* surface, const Settings& settings) const override {
    const ReflectanceFit* const fitted = fit.as<ReflectanceFit>();
    if (!surface || !fit.lightEstimate || !fitted) return Failure{surface ? Reason::NoLight : Reason::NoSurface, ""};
    const Light& light = *fit.lightEstimate;
    const RadianceField radiance(*surface, camera, fitted->lobe, fitted->roughness, *fit.lamp());
    const auto mirrorPoints = brightestPointsFor(*surface, camera, light, settings);
    if (mirrorPoints && settings.text("predict.contour") == "star")
      if (Outcome<std::vector<PredictedHighlight>> found =
              radianceStars(radiance, *fitted, light, *mirrorPoints, kFaintest, camera, *surface, settings))
        return std::move(*found);
    std::vector<Pixel> starts;
    if (mirrorPoints)
      for (const BrightestPoint& b : *mirrorPoints) starts.push_back(b.pixel);
    const std::vector<RadiancePeak> peaks = radiance.peaks(starts, kScanStepPx);
    if (peaks.empty())
      return mirrorPoints ? Failure{Reason::NoBrightestPoint, "nothing in the image is lit"} : mirrorPoints.failure();
    if (peaks.front().cut) return Failure{Reason::OutsideImage, "the radiance rises beyond the image"};
    if (const double fall = radiance.fallOfLobe(peaks.front().point); !(fall < kFaintest))
      return Failure{Reason::NoBrightestPoint, "no visible point is near the mirror direction of the light"};
    SurfaceField field;
    const double contour = peaks.front().logRadiance + std::log(fitted->level);
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
