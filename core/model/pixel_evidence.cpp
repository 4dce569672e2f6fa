// SPDX-License-Identifier: BSD-3-Clause
#include "core/model/pixel_evidence.h"

#include <algorithm>
#include <cmath>
#include <cstdio>
#include <deque>
#include <map>
#include <utility>

#include "core/base/number_text.h"
#include "core/geometry/transforms.h"
#include "core/light/estimate.h"
#include "core/model/models.h"
#include "core/model/plausible.h"
#include "core/model/reflectance_settings.h"

namespace glint {
namespace {

constexpr int kWidthPoints = 36;            // of a contour, for the first guess of the roughness
constexpr std::size_t kFewestContours = 3;  // that tell a lamp's shape
// Share of a contour's radius: right lobes leave a tenth of it between contours and pixels, 2 % where JPEG of quality 20 moves
// the contours.
constexpr double kContradiction = 0.025;
constexpr double kBlurShift = 1.5;  // times blur^2 / radius: how far blur moves a contour, of a lobe with a long tail too

/// Pixels of views with the light's strength of each: under known lamps, which were carried to one, every frame's lamp has its
/// own.
class PatchesOfViews {
 public:
  explicit PatchesOfViews(const std::vector<TrainingView>& views) {
    std::map<std::pair<int, std::string>, int> strengths;
    for (const TrainingView& v : views) {
      if (!v.seen || !v.pixels) continue;
      const bool carried = v.known || !isIdentity(v.fromScene);
      if (carried) carried_.push_back(carriedBy(*v.pixels, v.fromScene));
      if (v.known) {
        const int own = static_cast<int>(strengths.size());
        carried_.back().frame = strengths.try_emplace({v.frame, v.highlight.light}, own).first->second;
      }
      pointers_.push_back(carried ? &carried_.back() : v.pixels.get());
    }
  }
  PatchesOfViews(const PatchesOfViews&) = delete;
  PatchesOfViews& operator=(const PatchesOfViews&) = delete;
  const std::vector<const PixelPatch*>& all() const { return pointers_; }

 private:
  std::deque<PixelPatch> carried_;
  std::vector<const PixelPatch*> pointers_;
};

std::vector<ReflectedRay> peakRays(const std::vector<TrainingView>& views) {
  std::vector<ReflectedRay> rays;
  for (const TrainingView& v : views)
    if (v.seen) rays.push_back(reflectedRay(v.seen->brightest, v.camera));
  return rays;
}

/// The mean direction of the reflected peak rays, which no noise turns behind the surface.
std::optional<Light> meanRay(const std::vector<ReflectedRay>& rays) {
  Eigen::Vector3d mean = Eigen::Vector3d::Zero();
  for (const ReflectedRay& r : rays) mean += r.direction;
  // Directions that cancel have no mean: 1e-6 is far above round-off.
  return mean.norm() > 1e-6 * double(rays.size()) ? std::optional<Light>(Light::towards(mean)) : std::nullopt;
}

/// A sphere or a segment that explains the pixels clearly better than a point. The contours start the search: they tell a lamp's
/// shape quickly, and the pixels then measure it without the background's share.
std::optional<PixelFit> withExtent(const std::vector<TrainingView>& views, const std::vector<const PixelPatch*>& patches,
                                   const PixelFit& point, const Settings& settings, const ProgressFn& progress) {
  const LampChoices choices = lampChoicesOf(settings);
  if (choices.none() || point.model.lamp.atInfinity()) return std::nullopt;
  const Light centre = lightOf(point.model.lamp);
  std::vector<RadianceView> contours;
  for (const TrainingView& v : views)
    if (v.seen && v.pixels && !v.highlight.clipped)
      contours.push_back({v.frame, v.camera, v.surface.get(), v.highlight.contour.points, v.highlight.peak, v.highlight.level});
  const std::vector<Lobe> lobes = lobesOf(settings);
  std::optional<PixelFit> best;
  const auto consider = [&](const std::vector<Lobe>& order, const Lamp& lamp, const Roughness& roughness,
                            PixelFitOptions options = {}) {
    options.progress = progress;
    const Outcome<PixelFit> fit = fitPixels(order, patches, lamp, roughness, options);
    const PixelFit& before = best ? *best : point;
    if (fit && (before.poor && !fit->poor ? true : fit->poor == before.poor && explainsClearlyBetter(*fit, before))) best = *fit;
  };
  bool tried = false;
  if (contours.size() >= kFewestContours) {
    const double alpha = medianContourAngle(views, centre, kWidthPoints);
    RadianceFitOptions asking = radianceFitOptionsOf(settings);
    asking.progress = progress;
    const Outcome<RadianceFit> said =
        alpha > 0 ? searchRadiance(lobes, contours, centre, std::min(alpha, kWidestStart), choices, asking)
                  : Outcome<RadianceFit>(Failure{Reason::NoLight, ""});
    if (said && !said->poor && !said->lamp.isPoint()) {
      std::vector<Lobe> order = lobes;
      std::stable_partition(order.begin(), order.end(), [&](Lobe l) { return l == said->lobe; });
      consider(order, said->lamp, said->roughness);
      tried = true;
    }
  }
  if (!tried && admits<SphereShape<>>(choices)) {
    // Contours may hide a size that pixels show: the first guess is half the lobe's width. Residuals with a pattern may come from
    // a lamp that is wider than the lobe, which is then narrower than a point lamp makes it.
    const double distance = centre.position().norm();
    double reach = 0;
    for (const PixelPatch* p : patches) {
      const std::size_t middle = p->size() / 2;
      if (p->onSurface[middle]) reach = std::max(reach, (centre.position() - p->seen[middle].position).norm());
    }
    const double width = point.model.roughness * (reach > 0 ? reach : distance);
    PixelFitOptions same;
    same.background = point.background;
    const auto sphere = [&](double radius, const Roughness& roughness) {
      consider({point.model.lobe}, sphereLamp(centre, radius), roughness, same);
    };
    if (point.patterned) sphere(1.5 * width, {0.7 * point.model.roughness.mean, point.model.roughness.ratio});
    if (!best) sphere(0.5 * width, point.model.roughness);
  }
  return best;
}

/// A remark where the contours of the training views lie far from where a fit to their pixels puts them. Pixels far down the lobe
/// count in the fit as much as those at the contour: a lobe with another tail moves the contour, and the pixels' residuals may
/// still look small. Clipped highlights, whose level is not known, and the noise of contours do not count.
std::optional<std::string> contradiction(const std::vector<TrainingView>& views, const PixelFit& fit, const Settings& settings) {
  std::vector<RadianceView> contours;
  std::vector<UsedContour> used;
  for (const TrainingView& v : views) {
    if (!v.seen || v.highlight.clipped) continue;
    contours.push_back({v.frame, v.camera, v.surface.get(), v.highlight.contour.points, v.highlight.peak, v.highlight.level});
    used.push_back(usedContour(v));
  }
  RadianceFit at;
  at.lobe = fit.model.lobe;
  at.roughness = fit.model.roughness;
  at.lamp = fit.model.lamp;
  const std::vector<double> rms = rmsOfViews(at, contours, radianceFitOptionsOf(settings));
  double shares = 0, squares = 0, count = 0;
  for (std::size_t i = 0; i < rms.size(); ++i) {
    if (!std::isfinite(rms[i])) continue;
    // The fit knows the blur; the contours are moved by it.
    const double known = std::max(used[i].noise, kBlurShift * fit.model.blurPx() * fit.model.blurPx() / used[i].radius);
    const double left = std::max(0.0, rms[i] * rms[i] - known * known);
    shares += left / (used[i].radius * used[i].radius);
    squares += left;
    count += 1;
  }
  if (!(count > 0) || !(std::sqrt(shares / count) > kContradiction)) return std::nullopt;
  return formatted(
      "the contours of the training views lie %.3g px from those of the fit to the pixels, %.3g %% of their radius: lobe, light "
      "or surface may be wrong",
      std::sqrt(squares / count), 100 * std::sqrt(shares / count));
}

/// Equal to the last bit in all that a fit to pixels looks at beside the surface.
bool showTheSame(const TrainingView& a, const TrainingView& b) {
  const Highlight &h = a.highlight, &k = b.highlight;
  return a.frame == b.frame && a.pixels == b.pixels && a.camera.pixelFromRay == b.camera.pixelFromRay &&
         a.camera.camFromWorld.matrix() == b.camera.camFromWorld.matrix() && h.level == k.level && h.clipped == k.clipped &&
         h.peak == k.peak && h.contour.points == k.contour.points;
}

}  // namespace

bool havePixels(const std::vector<TrainingView>& views) {
  bool any = false;
  for (const TrainingView& v : views) {
    if (!v.seen) continue;
    if (!v.pixels) return false;
    any = true;
  }
  return any;
}

Outcome<PixelFit> fitViewsPixels(const std::vector<TrainingView>& views, const std::optional<LightEstimate>& light,
                                 const Settings& settings, const ProgressFn& progress, const PixelFit* near) {
  const PatchesOfViews own(views);
  const std::vector<const PixelPatch*>& patches = own.all();
  double level = 0.5;
  for (const TrainingView& v : views)
    if (v.seen && v.pixels) level = v.highlight.level;
  if (patches.empty()) return Failure{Reason::TooFewViews, "no training view has pixels"};
  // Views of known lamps were carried to one, which a fit keeps; who leaves a view out may ask without its light.
  const auto first = std::find_if(views.begin(), views.end(), [](const TrainingView& v) { return v.seen && v.pixels; });
  const bool known = first->known.has_value();
  PixelFitOptions options;
  options.holdLamp = known;
  options.progress = progress;
  if (near) {
    PixelFitOptions same = options;
    same.background = near->background;
    same.blur = near->model.blurVariance != 0;
    same.near = true;
    Outcome<PixelFit> fit = fitPixels({near->model.lobe}, patches, near->model.lamp, near->model.roughness, same);
    if (fit && !fit->poor) return fit;
  }
  const std::vector<Lobe> lobes = lobesOf(settings);
  std::vector<Lamp> starts;
  if (known || light) starts.push_back(known ? first->known->lamp : Lamp(light->light));
  const std::vector<ReflectedRay> rays = known ? std::vector<ReflectedRay>() : peakRays(views);
  // Where highlights are unequal, their contours lie at different shares of their own peaks, and mislead; their peaks do not.
  if (const Outcome<Triangulation> meet = triangulateLight(rays)) starts.push_back(meet->light);
  if (const std::optional<Light> mean = meanRay(rays)) starts.push_back(*mean);
  Outcome<PixelFit> best = Failure{Reason::NoLight, "no reflected ray to start from"};
  for (const Lamp& start : starts) {
    const double alpha = medianContourAngle(views, lightOf(start), kWidthPoints);
    if (!(alpha > 0)) continue;
    const double roughness =
        std::clamp(std::tan(alpha) / std::sqrt(-std::log(level)), 1e-3, 1.0);  // a start within the lobes' range
    Outcome<PixelFit> fit = fitPixels(lobes, patches, start, roughness, options);
    if (!best || (fit && (fit->poor != best->poor ? best->poor : fit->cost < best->cost))) best = std::move(fit);
    if (best && !best->poor) break;
  }
  if (best && !known && (best->poor || asksForExtent(*best)))
    if (std::optional<PixelFit> extended = withExtent(views, patches, *best, settings, progress)) best = *std::move(extended);
  if (best && best->poor) {
    const std::string detail = formatted("no lobe and light explain the pixels: %.3g px remain at the contours", best->rmsPx);
    return Failure{Reason::NotConverged, detail};
  }
  return best;
}

const Failure* UnexplainedPixels::answerTo(const std::vector<TrainingView>& otherViews,
                                           const std::optional<LightEstimate>& otherLight, const Settings& otherSettings) const {
  std::vector<const TrainingView*> asked, other;
  for (const TrainingView& v : views)
    if (v.seen) asked.push_back(&v);
  for (const TrainingView& v : otherViews)
    if (v.seen) other.push_back(&v);
  const auto start = [](const std::optional<LightEstimate>& l) {
    return l ? std::optional(l->light.homogeneous()) : std::nullopt;
  };
  const bool fewer = !other.empty() && other.size() < asked.size();
  const auto wasAsked = [&](const TrainingView* v) {
    return std::any_of(asked.begin(), asked.end(), [&](const TrainingView* a) { return showTheSame(*a, *v); });
  };
  const bool same = settings == otherSettings && (fewer || (other.size() == asked.size() && start(light) == start(otherLight))) &&
                    std::all_of(other.begin(), other.end(), wasAsked);
  return same ? &failure : nullptr;
}

Outcome<ModelFit> reflectanceFromPixels(const FitInput& input, const Settings& settings) {
  if (!havePixels(input.views)) return Failure{Reason::NotSupported, "not every training view has pixels"};
  const KnownPixels& said = input.pixels;
  if (said.unexplained && !said.fit)
    if (const Failure* const before = said.unexplained->answerTo(input.views, input.light, settings)) return *before;
  const Outcome<PixelFit> known = said.fit ? Outcome<PixelFit>(*said.fit)
                                           : fitViewsPixels(input.views, input.light, settings, input.progress, said.near.get());
  if (!known) return known.failure();
  const PixelFit& pixels = *known;
  ModelFit fit;
  double level = 0;
  for (const TrainingView& v : input.views) {
    if (!v.seen) continue;
    fit.frames.push_back(v.frame);
    level = v.highlight.level;
  }
  const Lamp& lamp = pixels.model.lamp;
  fit.lightEstimate = lightOf(lamp);
  if (!lamp.atInfinity() && pixels.positionCovariance.allFinite()) fit.lightCovariance = pixels.positionCovariance;
  fit.family = ReflectanceFit{pixels.model.lobe, pixels.model.roughness, level, lamp.shape, "pixels", {}, pixels.model.blurPx()};
  fit.residualPx = pixels.residualPx;
  fit.uncertainty = pixels.uncertainty;
  fit.solver = "pixels";
  if (input.light) fit.condition = input.light->condition;
  std::vector<UsedContour> used;
  for (const TrainingView& v : input.views)
    if (v.seen) used.push_back(usedContour(v));
  Outcome<ModelFit> judged = explaining(std::move(fit), used, true, settings.number("fit.most_residual"));
  if (judged && judged->remarks.empty())
    if (const std::optional<std::string> wrong = contradiction(input.views, pixels, settings)) judged->remarks.push_back(*wrong);
  if (judged && pixels.patterned && judged->remarks.empty()) {
    const std::string text = formatted(
        "the pixel residuals have a pattern (%.3g px at the contours): lobe, light or surface may be wrong", pixels.rmsPx);
    judged->remarks.push_back(text);
  }
  return judged;
}

}  // namespace glint
