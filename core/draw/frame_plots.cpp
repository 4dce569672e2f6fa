// SPDX-License-Identifier: BSD-3-Clause
// Plots with one place for each frame.
#include <algorithm>
#include <cmath>
#include <cstdlib>
#include <optional>

#include "core/base/number_text.h"
#include "core/draw/plot_text.h"
#include "core/draw/plots.h"
#include "core/pipeline/frame_score.h"
#include "core/pipeline/summary.h"

namespace glint::draw {
namespace {

bool isExcluded(const Inspection& inspection, int frame) { return !inspection.isTraining(frame) && !inspection.isHeldOut(frame); }

void shadeFrames(const Inspection& inspection, PlotData& plot) {
  const int n = int(inspection.evidence.size());
  const auto shade = [&](const Colour& colour, const char* name, const auto& isOne) {
    const std::size_t before = plot.shades.size();
    for (int f = 0; f < n; ++f) {
      if (!isOne(f)) continue;
      if (plot.shades.size() > before && plot.shades.back().to == f - 0.5)
        plot.shades.back().to = f + 0.5;
      else
        plot.shades.push_back({f - 0.5, f + 0.5, colour, name});
    }
  };
  if (!inspection.train.perSurface)  // else every frame trains: nothing to tell apart
    shade(kTraining, "training", [&](int f) { return inspection.isTraining(f); });
  shade(kExcluded, "excluded", [&](int f) { return isExcluded(inspection, f); });
}

/// ": mean 0.42 % over 30 of 33 held-out highlights, 3 missed": the mean and the counts of summarise(), which tables show.
std::string meanText(const Inspection& inspection, const std::string& model) {
  const ModelSummary s = summarise(inspection, inspection.models.at(model));
  const std::string of = inspection.train.perSurface ? "highlights" : "held-out highlights";
  if (s.contourErrorPct.count == 0) return ": none of the " + of + " found";
  return formatted(": mean %.3g %% over ", s.contourErrorPct.mean) + std::to_string(s.contourErrorPct.count) +
         (s.missed == 0 ? " " + of
                        : " of " + std::to_string(s.matched + s.missed) + " " + of + ", " + std::to_string(s.missed) + " missed");
}

}  // namespace

PlotData errorPlot(const Inspection& inspection, const ErrorPlotOptions& options) {
  PlotData plot;
  plot.id = "error";
  plot.title = "Contour error per frame";
  plot.x.title = "frame";
  plot.x.counts = true;
  plot.y.title = "contour error (%)";
  plot.y.floor = kSmallestPct;
  plot.noValue = "missed a highlight";
  plot.triangles = "spurious highlight";
  const std::size_t n = inspection.evidence.size();
  if (n == 0) return nothing(plot, "No results yet");
  // The axis counts frames, by their ids where these are no such count.
  bool counted = true;
  for (std::size_t i = 0; i < n && inspection.scene; ++i)
    counted = counted && std::atoi(inspection.scene->frames[i].id.c_str()) == int(i);
  for (std::size_t i = 0; i < n && !counted; ++i) plot.x.names.emplace_back(double(i), frameName(inspection, int(i)));
  std::vector<double> values;
  std::vector<std::string> silent;  // models that matched no highlight at all: their crosses would fill the plot
  for (const std::string& model : modelsInOrder(inspection, options.models)) {
    PlotSeries series =
        modelSeries(model, isPoor(inspection.models.at(model)), n <= 150 ? PlotShape::LineAndPoints : PlotShape::Line);
    series.pointSize = n <= 40 ? 6 : 4;
    series.width = n <= 400 ? 1.75 : 1.25;
    const std::vector<FrameScore> scores = frameScores(inspection.models.at(model), int(n));
    if (options.means) series.name += meanText(inspection, model);
    bool matched = false;
    for (std::size_t f = 0; f < n; ++f) {
      const FrameScore& score = scores[f];
      const bool excluded = isExcluded(inspection, int(f));
      const std::optional<double> pct = excluded ? std::nullopt : wholeErrorPct(score);
      PlotPoint p;
      p.x = double(f);
      p.y = pct.value_or(std::nan(""));
      p.noValue = !excluded && score.missed > 0;
      p.target.frame = int(f);
      p.target.model = model;
      const char* role = inspection.isTraining(int(f)) ? "training" : excluded ? "excluded" : "held out";
      p.label = "frame " + frameName(inspection, int(f)) + " (" + role + ")\n" + model + "  ";
      if (excluded)
        p.label += "not evaluated";
      else if (pct)
        p.label += formatted("%.3g %%", *pct);
      else if (p.noValue)
        p.label += missedText(score) + (score.reason.empty() ? "" : "\n" + score.reason);
      else
        p.label += score.reason.empty() ? "nothing to compare" : score.reason;
      p.triangle = !excluded && score.spurious > 0;
      if (p.triangle) p.label += "\n" + spuriousText(score);
      if (pct) values.push_back(*pct);
      matched = matched || (!excluded && score.matched > 0);
      series.points.push_back(std::move(p));
    }
    if (matched)
      plot.series.push_back(std::move(series));
    else
      silent.push_back(model);
  }
  if (plot.series.empty()) return nothing(plot, "No model predicted an observed highlight");
  if (silent.size() == 1) plot.title += "   (" + silent[0] + ": no highlight predicted)";
  if (silent.size() > 1) plot.title += formatted("   (%zu models: no highlight predicted)", silent.size());  // names would be cut
  plot.y.log = needsLogAxis(values);
  if (!plot.y.log) plot.y.from = 0;
  plot.x.from = -0.5;
  plot.x.to = double(n) - 0.5;
  shadeFrames(inspection, plot);
  return plot;
}

PlotData influencePlot(const Inspection& inspection, const Influence& influence, const std::string& model) {
  PlotData plot;
  plot.id = "influence";
  const bool probes = !influence.probes.empty();
  plot.title = probes ? "Held-out error without a frame" : "Error of a frame predicted from the others";
  plot.x.title = "frame left out";
  plot.y.title = probes ? "change (percentage points)" : "contour error (%)";
  plot.noValue = "no prediction without it";
  std::vector<std::string> models;
  for (const std::string& m : modelsInOrder(inspection))
    if (model.empty() || m == model) models.push_back(m);
  if (influence.frames.empty()) return nothing(plot, "No training frame can be left out");
  if (models.empty()) return nothing(plot, model.empty() ? "No models computed" : "The model '" + model + "' was not computed");
  const double width = 0.8 / double(models.size());
  bool any = false;
  std::string why;  // the first reason for no answer
  for (std::size_t m = 0; m < models.size(); ++m) {
    PlotSeries series = modelSeries(models[m], isPoor(inspection.models.at(models[m])), PlotShape::Bars);
    series.barWidth = width * 0.9;
    for (const ModelResult::Fit& fit : inspection.models.at(models[m]).fits)
      if (fit.failure() && why.empty()) why = models[m] + " has no fit: " + fit.failure()->message();
    for (std::size_t i = 0; i < influence.frames.size(); ++i) {
      const FrameInfluence& f = influence.frames[i];
      const std::optional<double> value = influenceOf(influence, f.frame, models[m]);
      const auto it = f.models.find(models[m]);
      if (it == f.models.end()) continue;
      const ModelInfluence& n = it->second;
      PlotPoint p;
      p.x = double(i) + width * (double(m) - 0.5 * double(models.size() - 1));
      p.y = value.value_or(std::nan(""));
      p.noValue = !value;
      any = any || value;
      p.target.frame = f.frame;
      p.target.model = models[m];
      p.label = models[m] + " without frame " + frameName(inspection, f.frame);
      if (n.failure) {
        p.label += "\nno fit: " + n.failure->message();
        if (why.empty())
          why = models[m] + " has no fit without frame " + frameName(inspection, f.frame) + ": " + n.failure->message();
      }
      if (n.changePct && n.heldOutPct)
        p.label += formatted("\nheld-out frames %.3g %% instead of %.3g %%: %+.2g points", *n.heldOutPct,
                             *n.heldOutPct - *n.changePct, *n.changePct) +
                   (*n.changePct < 0 ? "\nbetter without it" : "");
      if (n.leftOutPct) p.label += formatted("\nerror of this frame %.3g %%", *n.leftOutPct);
      if (n.lightShift) p.label += formatted("\nlight or centre moves %.2g m", *n.lightShift);
      if (n.axesChange) p.label += formatted("\na semi-axis changes by %.2g %% of its length", 100 * *n.axesChange);
      series.points.push_back(std::move(p));
    }
    plot.series.push_back(std::move(series));
  }
  if (!any) return nothing(plot, !why.empty() ? why : std::string("No predictions with any one training frame left out"));
  for (std::size_t i = 0; i < influence.frames.size(); ++i)
    plot.x.names.emplace_back(double(i), frameName(inspection, influence.frames[i].frame));
  return plot;
}

}  // namespace glint::draw
