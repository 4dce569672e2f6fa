// SPDX-License-Identifier: BSD-3-Clause
#include "core/advise/highlight_evidence.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <map>

#include "core/base/number_text.h"
#include "core/base/numeric.h"
#include "core/model/models.h"
#include "core/model/plausible.h"
#include "core/pipeline/fit_engine.h"
#include "core/pipeline/metrics.h"
#include "core/pipeline/training.h"
#include "core/surface/occlusion.h"

namespace glint {

namespace {

// Factor between two limit angles of one light; at most 1.02 in shipped sessions (`glint diagnose --json`, limit_angle_deg).
constexpr double kConflict = 1.25;
constexpr double kOutlier = 1.12;    // of a limit angle from the median of its light: half of that, as a ratio
constexpr double kLargeShare = 0.1;  // of the radius that a residual leaves: the default of fit.most_residual
constexpr double kManyTimes = 3;     // times the median residual

/// The common light; if its bundle failed, the light of the peaks alone, so that the failure can be explained.
Outcome<LightEstimate> lightAnyway(const Inspection& inspection, const FitKey& key) {
  const auto known = inspection.lights.find(key);
  if (known != inspection.lights.end() && known->second) return known->second;
  Settings settings = inspection.request.settings;
  settings.setFromText("light.solver", "triangulated");
  return estimateLight(inspection.viewsOf(key), settings);
}

/// The model's fit to the views of one key; where that failed, one that is refused by nothing.
Outcome<ModelFit> fitAnyway(const Inspection& inspection, const HighlightModel& model, const FitKey& key,
                            const ProgressFn& progress) {
  if (const auto result = inspection.models.find(model.id()); result != inspection.models.end())
    for (const ModelResult::Fit& known : result->second.fits)
      if (known.key() == key && known.fit) return known.fit;
  Settings settings = inspection.request.settings;
  settings.set("fit.most_residual", 10.0);
  std::optional<Outcome<LightEstimate>> light;
  if (model.needsLight()) {
    light = lightAnyway(inspection, key);
    if (!*light) return light->failure();
  }
  std::vector<TrainingView> views = inspection.viewsOf(key);
  if (model.needsCanonicalContours() && light)
    for (TrainingView& v : views)
      if (v.seen && !v.canonical) addCanonicalContour(v, (*light)->light, settings);
  const auto pixels = inspection.pixelFits.find(key);
  return fitModel(model, std::move(views), light, settings,
                  pixels != inspection.pixelFits.end() && pixels->second ? KnownPixels{*pixels->second} : KnownPixels{},
                  progress);
}

/// What the fit leaves of each of its views, by the view's place in Inspection::views.
void addResiduals(const Inspection& inspection, const HighlightModel& model, const ProgressFn& progress,
                  std::vector<HighlightEvidence>& evidence) {
  std::map<FitKey, std::vector<std::size_t>> usedBy;
  for (std::size_t i = 0; i < inspection.views.size(); ++i) {
    const TrainingView& v = inspection.views[i];
    if (v.seen || !model.needsLight()) usedBy[inspection.keyFor(v.frame, v.highlight.light)].push_back(i);
  }
  for (const auto& [key, used] : usedBy) {
    if (!report(progress, {"fit", 0, 0})) throw Stopped{};
    const Outcome<ModelFit> fit = fitAnyway(inspection, model, key, progress);
    if (!fit) continue;
    std::size_t next = 0;  // residualPx and frames are of the views that the fit used, in their order
    for (const std::size_t i : used) {
      if (next >= fit->residualPx.size() || next >= fit->frames.size()) break;
      if (fit->frames[next] != evidence[i].frame) continue;
      if (std::isfinite(fit->residualPx[next])) evidence[i].residualPx = fit->residualPx[next];
      ++next;
    }
  }
}

void addLimitAngles(const Inspection& inspection, std::vector<HighlightEvidence>& evidence) {
  std::map<FitKey, Outcome<LightEstimate>> lights;
  for (std::size_t i = 0; i < inspection.views.size(); ++i) {
    const TrainingView& v = inspection.views[i];
    if (!v.seen) continue;
    const FitKey key = inspection.keyFor(v.frame, v.highlight.light);
    auto light = lights.find(key);
    if (light == lights.end()) light = lights.emplace(key, lightAnyway(inspection, key)).first;
    if (!light->second) continue;
    const double alpha =
        medianContourAngle({v}, light->second->light, inspection.request.settings.integer("light.bundle_points"));
    if (alpha > 0) evidence[i].limitAngle = alpha;
  }
}

double medianOf(const std::vector<HighlightEvidence>& all, const std::string& light,
                const std::function<std::optional<double>(const HighlightEvidence&)>& value) {
  std::vector<double> values;
  for (const HighlightEvidence& e : all)
    if (const std::optional<double> v = e.light == light ? value(e) : std::nullopt) values.push_back(*v);
  return values.empty() ? std::nan("") : upperMedian(std::move(values));
}

/// Diameter of the residual's contour: on a bent surface the canonical one is several times as large as the highlight.
double fittedRadiusPx(const TrainingView& view, const HighlightModel& model) {
  const std::optional<ConicView> outline = model.hasOutlines() ? model.outlineIn(view) : std::nullopt;
  return outline ? std::sqrt(outline->ellipse.semiAxes.prod()) : radiusPx(view.highlight.contour);
}

void weigh(const Inspection& inspection, const HighlightModel& model, std::vector<HighlightEvidence>& all) {
  for (std::size_t i = 0; i < all.size(); ++i) {
    HighlightEvidence& e = all[i];
    const TrainingView& view = inspection.views[i];
    if (!view.seen) {
      e.against.push_back("cannot be used: " + view.seen.failure().message());
      e.weight += 1;
    }
    const double typical = medianOf(all, e.light, [](const HighlightEvidence& h) { return h.residualPx; });
    const double share = e.residualPx ? *e.residualPx / fittedRadiusPx(view, model) : 0;
    if (share > kLargeShare || (e.residualPx && *e.residualPx > kManyTimes * typical && share > kLargeShare / 5)) {
      e.against.push_back(formatted("%.3g px of its contour remain, %.2g %% of its radius (median of the light: %.3g px)",
                                    *e.residualPx, 100 * share, typical));
      e.weight += share / kLargeShare;
    }
    const double limit = medianOf(all, e.light, [](const HighlightEvidence& h) { return h.limitAngle; });
    if (e.limitAngle && (*e.limitAngle > kOutlier * limit || limit > kOutlier * *e.limitAngle)) {
      e.against.push_back(
          formatted("its limit angle is %.3g\u00b0, the light's median %.3g\u00b0", degrees(*e.limitAngle), degrees(limit)));
      e.weight += std::abs(std::log(*e.limitAngle / limit)) / std::log(kOutlier);
    }
    if (view.highlight.touchesBorder) e.against.push_back("it is cut by the image's border"), e.weight += 0.5;
    if (view.highlight.clipped) e.against.push_back("its core is clipped"), e.weight += 0.2;
  }
}

}  // namespace

std::vector<HighlightEvidence> highlightEvidence(const Inspection& inspection, const HighlightModel& model,
                                                 const ProgressFn& progress) {
  std::vector<HighlightEvidence> all;
  for (const TrainingView& v : inspection.views) {
    HighlightEvidence e;
    e.frame = v.frame;
    e.light = v.highlight.light;
    const std::vector<Highlight>& seen = inspection.evidence[std::size_t(v.frame)].highlights;
    const auto at = std::find_if(seen.begin(), seen.end(), [&](const Highlight& h) { return h.peak == v.highlight.peak; });
    if (at != seen.end()) e.highlight = static_cast<int>(at - seen.begin());
    e.peak = v.highlight.peak;
    e.radiusPx = radiusPx(v.highlight.contour);
    all.push_back(std::move(e));
  }
  addResiduals(inspection, model, progress, all);
  addLimitAngles(inspection, all);
  weigh(inspection, model, all);
  return all;
}

LimitConflict limitConflict(const std::vector<HighlightEvidence>& evidence) {
  LimitConflict worst;
  double ratio = kConflict;
  for (const HighlightEvidence& a : evidence)
    for (const HighlightEvidence& b : evidence) {
      if (a.light != b.light || !a.limitAngle || !b.limitAngle || *a.limitAngle <= ratio * *b.limitAngle) continue;
      ratio = *a.limitAngle / *b.limitAngle;
      worst = {&a, &b};
    }
  return worst;
}

namespace {

constexpr double kGrazing =
    75;  // degrees from the normal: four times as many highlight pixels per surface as seen frontally, and a weak lobe
constexpr double kNear = 1.5;  // radii of the highlight within which a candidate of detection is the same spot

/// "outside of the image", where most of the contour is not in it.
bool isOutside(const Camera& camera, const Polyline& contour) {
  const auto inside = std::count_if(contour.points.begin(), contour.points.end(), [&](const Pixel& p) {
    const Pixel m = camera.distorted(p);
    return m.x() > -0.5 && m.y() > -0.5 && m.x() < camera.width - 0.5 && m.y() < camera.height - 0.5;
  });
  return 2 * inside < static_cast<long>(contour.points.size());
}

/// What hides the lamp from the middle of the contour on the surface, or how flat it is seen; "" if neither does, or where
/// that misses the surface. A brightest point would not do: `primal` predicts outlines that no point of the surface made.
std::string geometryAgainst(const Inspection& inspection, const FrameComparison& c, const PredictedHighlight& h) {
  const Camera camera = inspection.cameraFor(c.frame, c.light);
  const Eigen::Vector3d eye = camera.centreInWorld();
  const LightEstimate* const light = inspection.lightFor(c.frame, c.light);
  const Outcome<std::shared_ptr<const Surface>> surface = surfaceFor(inspection, c.frame, c.light);
  if (!surface || !*surface) return "";
  const Outcome<SurfacePoint> hit = (*surface)->firstHit(camera.ray(centroid(h.contour)));
  if (!hit) return "";
  const SurfacePoint at = facing(*hit, eye);
  if (light && (*surface)->occluded(at, occlusionTarget(**surface, at.position, light->light, (eye - at.position).norm())))
    return "in the shadow of the object itself";
  const double cosine = at.normal.dot((eye - at.position).normalized());
  if (const double angle = degrees(std::acos(std::clamp(cosine, -1.0, 1.0))); angle > kGrazing)
    return formatted("at grazing incidence: seen %.0f\u00b0 from the normal", angle);
  return "";
}

/// What detection said of a spot there; "" if it saw none.
std::string detectionAgainst(const FrameEvidence& seen, const Camera& camera, const PredictedHighlight& h) {
  const double radius = kNear * std::max(2.0, radiusPx(h.contour));
  const Pixel middle = camera.distorted(centroid(h.contour));
  for (const RejectedCandidate& r : seen.rejected)
    if ((r.place - middle).norm() < radius) return "detection saw a spot there and did not take it: " + r.reason;
  return "";
}

template <class Highlights, class PlaceOf>
std::string nearest(const Highlights& others, const Pixel& place, const char* what, const PlaceOf& placeOf) {
  double distance = std::numeric_limits<double>::infinity();
  for (const auto& other : others) distance = std::min(distance, (placeOf(other) - place).norm());
  return std::isfinite(distance) ? formatted("the nearest %s is %.3g px away", what, distance)
                                 : std::string("there is no ") + what;
}

}  // namespace

std::string whyUnmatched(const Inspection& inspection, const FrameComparison& c, const FrameComparison::Row& row) {
  if (row.metrics) return "";
  // That nothing overlaps is what is to be explained.
  const bool unanswered = row.observed >= 0 && row.predicted < 0 && !c.prediction.failure();
  if (row.failure && !unanswered) return row.failure->message();
  const Frame& frame = inspection.scene->frames[std::size_t(c.frame)];
  const FrameEvidence& seen = inspection.evidence[std::size_t(c.frame)];
  const std::vector<Highlight>& observed = seen.scored();
  if (row.predicted >= 0 && row.predicted < static_cast<int>(c.prediction.highlights().size())) {
    const PredictedHighlight& h = c.prediction.highlights()[std::size_t(row.predicted)];
    if (isOutside(frame.camera, h.contour)) return "outside of the image";
    if (std::string why = geometryAgainst(inspection, c, h); !why.empty()) return why;
    if (std::string why = detectionAgainst(seen, frame.camera, h); !why.empty()) return why;
    const double area = std::abs(signedArea(h.contour)), least = inspection.request.settings.number("detect.min_area");
    if (area < least)
      return formatted("smaller than the smallest highlight that detection takes: %.2g of %.3g px^2", area, least);
    if (seen.scoringFailure()) return seen.scoringFailure()->message();
    return nearest(observed, centroid(h.contour), "observed highlight", [](const Highlight& o) { return centroid(o.contour); });
  }
  if (row.observed < 0 || row.observed >= static_cast<int>(observed.size())) return "";
  if (c.prediction.failure()) return c.prediction.failure()->message();
  const Highlight& missed = observed[std::size_t(row.observed)];
  for (const FilteredHighlight& f : c.prediction.filtered)
    if (regionIou({missed.contour}, {f.highlight.contour}) > 0) return "its prediction is filtered: " + f.reason;
  std::string why = nearest(c.prediction.highlights(), centroid(missed.contour), "predicted highlight",
                            [](const PredictedHighlight& p) { return centroid(p.contour); });
  if (missed.touchesBorder) why += "; it is cut by the image's border";
  return why;
}

}  // namespace glint
