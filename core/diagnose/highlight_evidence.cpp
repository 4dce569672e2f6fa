// SPDX-License-Identifier: BSD-3-Clause
#include "core/diagnose/highlight_evidence.h"

#include <algorithm>
#include <cmath>
#include <map>

#include "core/base/angle.h"
#include "core/base/median.h"
#include "core/base/number_text.h"
#include "core/fit/fit_engine.h"
#include "core/fit/training.h"
#include "core/model/models.h"
#include "core/model/plausible.h"

namespace glint {
namespace {

// Factor between two limit angles of one light; at most 1.02 in shipped sessions (`glint diagnose --json`, limit_angle_deg).
constexpr double kConflict = 1.25;
constexpr double kOutlier = 1.12;    // of a limit angle from the median of its light: half of that, as a ratio
constexpr double kLargeShare = 0.1;  // of the radius that a residual leaves: the default of fit.most_residual
constexpr double kManyTimes = 3;     // times the median residual

std::vector<TrainingView> viewsOf(const Inspection& inspection, const FitKey& key) {
  std::vector<TrainingView> views;
  for (const TrainingView& v : inspection.views)
    if (inspection.keyFor(v.frame, v.highlight.light) == key) views.push_back(v);
  return views;
}

/// The common light; if its bundle failed, the light of the peaks alone, so that the failure can be explained.
Outcome<LightEstimate> lightAnyway(const Inspection& inspection, const FitKey& key) {
  const auto known = inspection.lights.find(key);
  if (known != inspection.lights.end() && known->second) return known->second;
  Settings settings = inspection.request.settings;
  settings.setFromText("light.solver", "triangulated");
  return estimateLight(viewsOf(inspection, key), settings);
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
  std::vector<TrainingView> views = viewsOf(inspection, key);
  if (model.needsCanonicalContours() && light)
    for (TrainingView& v : views)
      if (v.seen && !v.canonical) addCanonicalContour(v, (*light)->light, settings);
  const auto pixels = inspection.pixelFits.find(key);
  return fitModel(model, std::move(views), light, settings,
                  pixels != inspection.pixelFits.end() && pixels->second ? *pixels->second : nullptr, progress);
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

}  // namespace glint
