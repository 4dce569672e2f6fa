// SPDX-License-Identifier: BSD-3-Clause
#include "core/draw/plots.h"

#include <algorithm>
#include <cmath>
#include <exception>
#include <limits>

#include "core/base/number_text.h"
#include "core/base/numeric.h"
#include "core/base/words.h"
#include "core/draw/plot_text.h"
#include "core/pipeline/frame_score.h"
#include "core/pipeline/photograph.h"

namespace glint::draw {
namespace {

constexpr Colour kFittedLobe{0.25, 0.56, 0.86};  // no model's; readable on white points and on both backgrounds

std::string ofFrame(const FrameSamples& samples) { return samples.frameId.empty() ? "" : ", frame " + samples.frameId; }

}  // namespace

const std::vector<PlotKind>& plotKinds() {
  static const std::vector<PlotKind> all = {
      {"error", "Error per frame",
       "Contour error of every frame and model; training and excluded frames are tinted. A cross at the top marks a missed "
       "highlight, for which there is no error. Click to select frame and model."},
      {"dial", "Residual dial",
       "Signed distance from the observed to the predicted contour, px, by direction in the photograph; outside the circle: "
       "prediction too large. Beside the models: mean |d|. The px of the error table is a different measure, the mean "
       "contour distance: symmetric, over the length of both contours."},
      {"limit-angle", "Limit angle by direction",
       "alpha = angle(N, H) along the contours: the same value in all directions if the highlight is a level set of the angle."},
      {"lobe", "Lobe", "Logarithm of radiance against alpha, with the lobe |alpha| = m sqrt(-log I/K') fitted to the pixels."},
      {"scatter", "Any two columns",
       "Two numbers of every highlight, one dot each. Click selects, dragging a rectangle brushes: the table of errors can show "
       "what is "
       "brushed. A highlight without a value is counted in words and not drawn; rings have no error."},
      {"lobes", "Every lobe",
       "Radiance of one highlight over its peak against alpha, means of the pixels with their spread, and every lobe fitted to "
       "them: "
       "roughness m and the residual in % of the peak. Clipped pixels are left out. \"As good\" is what the pixels cannot tell "
       "from the "
       "best. For a point light."},
      {"axes", "Semi-axes", "Semi-axes of each model's ellipsoid, longest first, with one standard deviation where it is known."},
      {"singular", "Singular values",
       "Singular values of the linear system for Q*. A small last value beside a large second-last value means a well-determined "
       "ellipsoid."},
      {"influence", "Influence of frames",
       "Each training frame left out in turn: increase of the held-out error without it, in percentage points. "
       "Errors are capped at 100 %."},
      {"tradeoff", "Speed and accuracy",
       "Error against time per frame of every measured setting. Click a point to load its setting."}};
  return all;
}

namespace {
std::set<std::string> poorLightsIn(const Inspection& inspection, int frame, const std::string& model) {
  std::set<std::string> lights;
  if (const auto it = inspection.models.find(model); it != inspection.models.end())
    for (const FrameComparison& c : it->second.frames)
      if (c.frame == frame && !poorFit(it->second, c).empty()) lights.insert(c.light);
  return lights;
}

PlotSeries observedSeries() {
  PlotSeries series;
  series.colour = kObserved;
  series.halo = true;
  return series;
}

void storeSamples(FrameSamples::Lobe& lobe, Outcome<LobeSamples> samples) {
  if (!samples) {
    lobe.failure = samples.failure();
    return;
  }
  lobe.samples = std::move(*samples);
  Outcome<LobeComparison> comparison = compareLobes(*lobe.samples);
  if (comparison)
    lobe.comparison = std::move(*comparison);
  else
    lobe.comparisonFailure = comparison.failure();
}

FrameSamples samplesInScene(const Inspection& inspection, int frame, const std::string& model) {
  FrameSamples result;
  result.frame = frame;
  result.model = model;
  result.frameId = frameName(inspection, frame);
  if (!inspection.scene || frame < 0 || frame >= int(inspection.evidence.size())) {
    result.failure = "No such frame.";
    return result;
  }
  result.poorLights = poorLightsIn(inspection, frame, model);
  const FrameEvidence& evidence = inspection.evidence[std::size_t(frame)];
  const Frame& source = inspection.scene->frames[std::size_t(frame)];
  if (evidence.scored().empty()) {
    result.failure = "Frame " + source.id + " shows no highlight" +
                     (evidence.failure ? ": " + evidence.failure->message() : std::string()) + ".";
    return result;
  }
  try {
    const Outcome<std::shared_ptr<const Surface>> surface = surfaceOfFrame(inspection, frame, evidence.scored().front().light);
    if (!surface) {
      result.failure = "No surface: " + surface.failure().message() + ".";
      return result;
    }
    result.angles = limitAngles(inspection, frame, model, **surface);
    const bool synthesised = picturesAreSynthesised(inspection);  // then the lobe alone is had without the matt part
    const Outcome<Image> linear =
        linearImageOf(inspection, frame, synthesised ? FrameSource::Radiance : inspection.request.source);
    const Outcome<std::optional<Image>> mask = readMask(source);
    const bool photograph =
        !synthesised && (source.radiance.empty() || (inspection.request.source == FrameSource::Image && !source.image.empty()));
    LobeOptions options;
    options.clipValue = inspection.request.settings.number("detect.clip");
    if (options.clipValue == 0 && photograph) options.clipValue = 1;  // linearised codes end at 1, as detection knows
    for (int o = 0; o < int(evidence.scored().size()); ++o) {
      const Highlight& h = evidence.scored()[std::size_t(o)];
      FrameSamples::Lobe lobe;
      lobe.observed = o;
      lobe.light = h.light;
      lobe.level = h.level;
      const Outcome<Light> light = lightOfModel(inspection, frame, model, h.light);
      if (!light) {
        lobe.failure = light.failure();
      } else if (!linear) {
        lobe.failure = linear.failure();
      } else if (!mask) {
        lobe.failure = mask.failure();
      } else {
        storeSamples(lobe,
                     lobeSamples(*linear, mask->has_value() ? &**mask : nullptr, h, source.camera, **surface, *light, options));
      }
      if (const auto it = inspection.models.find(model); it != inspection.models.end())
        for (const ModelResult::Fit& f : it->second.fits)
          if (f.fit && f.light == h.light && f.fit->as<ReflectanceFit>()) lobe.roughness = f.fit->as<ReflectanceFit>()->roughness;
      result.lobes.push_back(std::move(lobe));
    }
  } catch (const InputError& e) {
    result.failure = e.what();
  }
  return result;
}
}  // namespace

FrameSamples frameSamples(const Inspection& inspection, int frame, const std::string& model) {
  return samplesInScene(*inSceneAt(inspection, frame), frame, model);
}

const FrameSamples::Lobe* lobeOfHighlight(const FrameSamples& samples, int highlight) {
  const FrameSamples::Lobe* lobe = nullptr;
  for (const FrameSamples::Lobe& l : samples.lobes)
    if (l.observed == highlight || (highlight < 0 && !lobe)) lobe = &l;
  return lobe;
}

PlotData lobePlot(const FrameSamples& samples, int highlight) {
  PlotData plot;
  plot.id = "lobe";
  plot.title = "Radiance against alpha" + ofFrame(samples);
  plot.x.title = "alpha (\u00b0)";
  plot.y.title = "log I/K'";
  if (!samples.failure.empty()) return nothing(plot, samples.failure);
  const FrameSamples::Lobe* const lobe = lobeOfHighlight(samples, highlight);
  if (!lobe) return nothing(plot, "No highlight in this frame");
  if (!lobe->samples)
    return nothing(plot, "No lobe: " + (lobe->failure ? lobe->failure->message() : std::string("nothing sampled")));
  const LobeSamples& s = *lobe->samples;
  double highest = -std::numeric_limits<double>::infinity(), widest = 0;
  for (const LobeSample& p : s.samples) highest = std::max(highest, p.logI), widest = std::max(widest, p.alpha);
  const double height = s.fit ? s.fit->logHeight : highest;
  PlotSeries bright, faint;
  bright.name = "pixels, fitted";
  faint.name = "pixels, too faint to fit";
  bright.colour = kObserved;
  bright.halo = true;
  faint.colour = kHeldOut;
  bright.shape = faint.shape = PlotShape::Points;
  bright.pointSize = faint.pointSize = 4;
  double lowest = 0;
  for (const LobeSample& p : s.samples) {
    PlotPoint point;
    point.x = degrees(p.alpha);
    point.y = p.logI - height;
    lowest = std::min(lowest, point.y);
    point.target = {samples.frame, samples.model, lobe->light, lobe->observed, p.direction, -1};
    point.label = formatted("pixel %.1f, %.1f\nalpha %.3g\u00b0, I/K' %.3g\ndirection %.0f\u00b0", p.at.x(), p.at.y(),
                            degrees(p.alpha), std::exp(point.y), degrees(p.direction));
    (p.fitted ? bright : faint).points.push_back(std::move(point));
  }
  lowest = std::max(lowest, -6.0);  // a four-hundredth of the height: fainter pixels show the background
  plot.y.from = lowest - 0.15;
  plot.series = {std::move(faint), std::move(bright)};
  const auto addCurve = [&](const std::string& name, double m, const Colour& colour, Dash dash) {
    PlotSeries curve;
    curve.name = name;
    curve.colour = colour;
    curve.dash = dash;
    curve.width = 1.25;  // the pixels beneath stay visible
    for (int i = 0; i <= 100; ++i) {
      const double alpha = std::min(widest, m * std::sqrt(-lowest)) * i / 100;
      PlotPoint p;
      p.x = degrees(alpha);
      p.y = -alpha * alpha / (m * m);
      p.label = name;
      curve.points.push_back(p);
    }
    plot.series.push_back(std::move(curve));
  };
  if (s.fit) addCurve(formatted("fitted lobe, m = %.4g, rms %.2g", s.fit->m, s.fit->rms), s.fit->m, kFittedLobe, Dash::Solid);
  if (lobe->roughness) {
    const PlotSeries own = modelSeries(samples.model, samples.poorLights.count(lobe->light) > 0, PlotShape::Line);
    addCurve(own.name + formatted(", m = %.4g", *lobe->roughness), *lobe->roughness, own.colour, Dash::Dashed);
  }
  if (lobe->level > 0 && lobe->level < 1) {
    PlotSeries level;
    level.name = formatted("level %.3g", lobe->level);
    level.colour = kHeldOut;
    level.dash = Dash::Dotted;
    level.width = 1.5;
    for (const double x : {0.0, degrees(widest)}) {
      PlotPoint p;
      p.x = x;
      p.y = std::log(lobe->level);
      p.label = formatted("contour level %.3g of the peak", lobe->level) +
                (s.fit ? formatted("\nreached at alpha %.4g\u00b0 by the fitted lobe", degrees(s.fit->alphaAt(lobe->level)))
                       : std::string());
      level.points.push_back(p);
    }
    plot.series.push_back(std::move(level));
  }
  plot.x.from = 0;
  if (!s.fit && s.fitFailure) plot.title += "   no lobe fits: " + s.fitFailure->message();
  if (s.clipped > 0) plot.title += formatted("   %d clipped pixels left out", s.clipped);
  return plot;
}

PlotData semiAxesPlot(const Inspection& inspection) {
  PlotData plot;
  plot.id = "axes";
  plot.title = "Semi-axes";
  plot.y.title = "semi-axis (m)";
  plot.x.names = {{0, "longest"}, {1, "middle"}, {2, "shortest"}};
  struct One {
    std::string model, light;
    const ModelFit* fit;
  };
  std::vector<One> fits;
  std::string refused;
  for (const std::string& model : modelsInOrder(inspection))
    for (const ModelResult::Fit& f : inspection.models.at(model).fits) {
      if (f.fit && f.fit->ellipsoid())
        fits.push_back({model, f.light + (f.surface ? " on " + *f.surface : std::string()), &*f.fit});
      else if (f.failure())
        refused += (refused.empty() ? "" : "; ") + model + ": " + f.failure()->message();
    }
  if (fits.empty())
    return nothing(plot, inspection.models.empty()
                             ? "No results yet"
                             : "No model here has an ellipsoid" + (refused.empty() ? std::string() : " (" + refused + ")"));
  std::vector<double> values;
  bool severalLights = false;
  for (const One& o : fits) severalLights = severalLights || o.light != fits.front().light;
  for (std::size_t i = 0; i < fits.size(); ++i) {
    PlotSeries series = modelSeries(fits[i].model, !fits[i].fit->poor.empty(), PlotShape::Points);
    series.pointSize = 9;
    for (std::size_t before = 0; before < i; ++before) series.inLegend = series.inLegend && fits[before].model != fits[i].model;
    const std::optional<Eigen::Vector3d> sigma = semiAxesSigma(*fits[i].fit);
    const Eigen::Vector3d axes = fits[i].fit->ellipsoid()->semiAxes();
    for (int k = 0; k < 3; ++k) {
      PlotPoint p;
      p.x = k + 0.7 * ((double(i) + 0.5) / double(fits.size()) - 0.5);  // side by side, so that none hides another
      p.y = axes(k);
      if (axes(k) > 0) values.push_back(axes(k));
      p.target.model = fits[i].model;
      p.label = fits[i].model + (severalLights ? ", " + lightName(fits[i].light) : "") + formatted("\n%.6g m", axes(k));
      if (sigma && std::isfinite((*sigma)(k))) {
        p.band = {{axes(k) - (*sigma)(k), axes(k) + (*sigma)(k)}};
        p.label += formatted(" \u00b1 %.2g m", (*sigma)(k));
      }
      series.points.push_back(std::move(p));
    }
    plot.series.push_back(std::move(series));
  }
  plot.y.log = needsLogAxis(values);
  if (plot.y.log) {
    plot.y.floor = 0.3 * *std::min_element(values.begin(), values.end());
    if (values.size() < 3 * fits.size()) plot.y.title = "semi-axis (m; lowest = 0, flat)";
  } else
    plot.y.from = 0;
  plot.x.from = -0.5;
  plot.x.to = 2.5;
  return plot;
}

PlotData residualDial(const Inspection& inspection, int frame, int highlight) {
  PlotData plot;
  plot.id = "dial";
  plot.dial = true;
  plot.title = "Signed distance, px, frame " + frameName(inspection, frame);
  plot.x.title = "direction (rad)";
  plot.y.title = "signed distance, observed to predicted contour (px)";
  double largest = 0;
  std::vector<std::vector<PolarResidual>> residuals;
  const std::vector<std::string> models = modelsInOrder(inspection);
  int first = std::numeric_limits<int>::max();  // the same highlight for all models
  for (const std::string& model : models) {
    residuals.push_back(polarResiduals(inspection, frame, model));
    for (const PolarResidual& r : residuals.back()) first = std::min(first, r.observed);
  }
  const int shown = highlight >= 0 ? highlight : first;
  for (std::size_t m = 0; m < models.size(); ++m) {
    const std::string& model = models[m];
    const PolarResidual* chosen = nullptr;
    for (const PolarResidual& r : residuals[m])
      if (r.observed == shown) chosen = &r;
    if (!chosen || !std::isfinite(chosen->meanAbsPx)) continue;
    const ModelResult& result = inspection.models.at(model);
    const auto of = std::find_if(result.frames.begin(), result.frames.end(),
                                 [&](const FrameComparison& c) { return c.frame == frame && c.light == chosen->light; });
    PlotSeries series = modelSeries(model, of != result.frames.end() && !poorFit(result, *of).empty(), PlotShape::LineAndPoints);
    series.name += formatted("  mean |d| %.2g px", chosen->meanAbsPx);
    series.pointSize = 3;
    for (const DirectionSample& s : chosen->samples) {
      PlotPoint p;
      p.x = s.direction;
      p.y = s.value.value_or(std::nan(""));
      if (s.value) largest = std::max(largest, std::abs(*s.value));
      p.target = {frame, model, chosen->light, chosen->observed, s.direction, -1};
      p.label = model + formatted("\ndirection %.0f\u00b0\n%+.3g px", degrees(s.direction), s.value.value_or(0));
      series.points.push_back(std::move(p));
    }
    plot.series.push_back(std::move(series));
  }
  if (plot.series.empty()) return nothing(plot, "No prediction overlaps a highlight observed in this frame");
  plot.y.to = largest > 0 ? largest : 1;
  plot.y.from = -*plot.y.to;
  return plot;
}

PlotData limitAnglePlot(const FrameSamples& samples, int highlight) {
  PlotData plot;
  plot.id = "limit-angle";
  plot.title = "Limit angle, " + samples.model + ofFrame(samples);
  plot.x.title = "direction in the photograph (\u00b0; 0 = right, 90 = down)";
  plot.y.title = "alpha (\u00b0)";
  if (!samples.failure.empty()) return nothing(plot, samples.failure);
  const AngleByDirection* chosen = nullptr;
  for (const AngleByDirection& a : samples.angles)
    if (a.observed == highlight || (highlight < 0 && !chosen)) chosen = &a;
  if (!chosen)
    return nothing(
        plot, samples.model.empty() ? "No results yet" : "The model '" + samples.model + "' has no light for this highlight");
  const auto add = [&](PlotSeries series, const char* name, const std::vector<DirectionSample>& values, bool observed) {
    series.name = name;
    series.shape = PlotShape::LineAndPoints;
    series.pointSize = 4;
    bool any = false;
    for (const DirectionSample& s : values) {
      PlotPoint p;
      p.x = degrees(s.direction);
      p.y = s.value ? degrees(*s.value) : std::nan("");
      any = any || s.value.has_value();
      p.target = {samples.frame, observed ? std::string() : samples.model, chosen->light, chosen->observed, s.direction, -1};
      p.label = series.name + formatted("\ndirection %.0f\u00b0\nalpha %.4g\u00b0", p.x, p.y);
      series.points.push_back(std::move(p));
    }
    if (any) plot.series.push_back(std::move(series));
  };
  add(observedSeries(), "observed contour", chosen->measured, true);
  const bool poor = samples.poorLights.count(chosen->light) > 0;
  add(modelSeries(samples.model, poor, PlotShape::LineAndPoints), poor ? "predicted contour, poor" : "predicted contour",
      chosen->predicted, false);
  if (plot.series.empty()) return nothing(plot, "No contour point lies on the lit surface");
  if (chosen->limitAngle) {
    PlotSeries line;
    line.name = formatted(chosen->extended ? "limit angle %.4g\u00b0, without the lamp's extent" : "limit angle %.4g\u00b0",
                          degrees(*chosen->limitAngle));
    line.colour = kHeldOut;
    line.dash = Dash::Dashed;
    line.width = 1.5;
    for (const double x : {-180.0, 180.0}) {
      PlotPoint p;
      p.x = x;
      p.y = degrees(*chosen->limitAngle);
      p.label = line.name;
      line.points.push_back(p);
    }
    plot.series.push_back(std::move(line));
  }
  plot.x.from = -180;
  plot.x.to = 180;
  plot.x.names = {{-180, "-180"}, {-90, "-90"}, {0, "0"}, {90, "90"}, {180, "180"}};
  // Exact scenes differ in the tenth digit only: round-off is not to fill the plot.
  PlotRange r = rangeOf(plot);
  const double middle = 0.5 * (r.y0 + r.y1), least = 0.02 * std::abs(middle);
  if (r.y1 - r.y0 < least) plot.y.from = middle - 0.5 * least, plot.y.to = middle + 0.5 * least;
  return plot;
}

PlotData singularValuePlot(const std::vector<Conditioning>& conditioning) {
  PlotData plot;
  plot.id = "singular";
  plot.title = "Singular values";
  plot.x.title = "index";
  plot.y.title = "relative to the first";
  plot.y.log = true;
  plot.y.floor = 1e-17;  // below what doubles resolve of the first: zero is drawn there
  std::size_t most = 0;
  std::vector<std::string> named;
  for (const Conditioning& c : conditioning) {
    if (c.singularValues.empty() || !(c.singularValues.front() > 0)) continue;
    PlotSeries series = modelSeries(c.model, c.poor, PlotShape::LineAndPoints);
    series.inLegend = std::find(named.begin(), named.end(), series.name) == named.end();
    named.push_back(series.name);
    series.pointSize = 7;
    for (std::size_t i = 0; i < c.singularValues.size(); ++i) {
      PlotPoint p;
      p.x = double(i + 1);
      p.y = c.singularValues[i] / c.singularValues.front();
      p.target.model = c.model;
      p.label = c.model + ", " + lightName(c.light) + (c.surface ? " on " + *c.surface : std::string()) +
                formatted("\nsingular value %d of %d: %.3g", int(i + 1), int(c.singularValues.size()), c.singularValues[i]) +
                (i + 1 == c.singularValues.size() ? "\nQ* is a " + c.quadricKind : std::string());
      series.points.push_back(std::move(p));
    }
    most = std::max(most, c.singularValues.size());
    plot.series.push_back(std::move(series));
  }
  if (plot.series.empty())
    return nothing(plot, conditioning.empty() ? "No results yet" : "No model here solves a linear system for Q*");
  plot.x.from = 0.5;
  plot.x.to = double(most) + 0.5;
  for (std::size_t i = 1; i <= most; ++i) plot.x.names.emplace_back(double(i), std::to_string(i));
  return plot;
}

PlotData tradeoffPlot(const Tradeoff& tradeoff) {
  PlotData plot;
  plot.id = "tradeoff";
  plot.title = "Speed against accuracy";
  plot.x.title = "microseconds per frame";
  plot.y.title = "contour error (%; missed = 100)";
  plot.x.log = plot.y.log = true;
  plot.y.floor = kSmallestPct;
  PlotSeries front;
  front.name = "front";
  front.colour = kHeldOut;
  front.dash = Dash::Dashed;
  front.width = 1.5;
  std::vector<PlotSeries> models;
  for (int i = 0; i < int(tradeoff.points.size()); ++i) {
    const TradeoffPoint& t = tradeoff.points[std::size_t(i)];
    if (!std::isfinite(t.rankedErrorPct) || !(t.predictUs > 0)) continue;
    PlotPoint p;
    p.x = t.predictUs;
    p.y = t.rankedErrorPct;
    p.target.setting = i;
    p.label =
        describe(tradeoff, t) +
        formatted(
            "\nerror %.3g %%: what is missed or spurious counts as 100 %%\nfound %s highlights with %.3g %%, %d spurious, IoU "
            "%.4f, coverage %.3f\n%.4g µs per frame, fit %.3g ms, peak memory %.4g MB",
            t.rankedErrorPct, foundText(t).c_str(), t.contourErrorPct, t.spurious, t.iou, t.coverage, t.predictUs, t.fitUs / 1000,
            t.peakMb);
    if (!t.poor.empty()) p.label += "\npoor: " + t.poor;
    p.note = presetNames(tradeoff, i);
    if (!p.note.empty()) p.label += "\npreset " + p.note;
    if (tradeoff.chosen == i) p.note += p.note.empty() ? "chosen" : " (chosen)";
    p.hollow = !t.pareto;
    if (t.pareto) {
      PlotPoint step = p;
      step.note.clear();
      if (!front.points.empty()) {  // until then the error before is the best to be had
        PlotPoint corner;           // no setting lies there: it has no label and nothing to load
        corner.x = p.x;
        corner.y = front.points.back().y;
        front.points.push_back(corner);
      }
      front.points.push_back(step);
    }
    PlotSeries own = modelSeries(t.model, !t.poor.empty(), PlotShape::Points);
    own.pointSize = 8;
    auto series = std::find_if(models.begin(), models.end(), [&](const PlotSeries& s) { return s.name == own.name; });
    if (series == models.end()) series = models.insert(models.end(), std::move(own));
    series->points.push_back(std::move(p));
  }
  if (models.empty()) return nothing(plot, tradeoff.reason.empty() ? "No settings measured" : tradeoff.reason);
  plot.series.push_back(std::move(front));
  for (PlotSeries& s : models) plot.series.push_back(std::move(s));
  return plot;
}

}  // namespace glint::draw
