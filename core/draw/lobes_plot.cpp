// SPDX-License-Identifier: BSD-3-Clause
#include <algorithm>
#include <cmath>

#include "core/base/number_text.h"
#include "core/base/numeric.h"
#include "core/draw/plot_text.h"
#include "core/draw/plots.h"

namespace glint::draw {
namespace {

constexpr double kFloor = 2e-3;  // of the peak: below, 8 bits show nothing

PlotSeries measuredSeries(const LobeComparison& comparison) {
  PlotSeries measured;
  measured.name = formatted("measured, %d pixels", comparison.pixels);
  measured.colour = kObserved;
  measured.halo = true;
  measured.shape = PlotShape::Points;
  measured.pointSize = 5;
  for (const LobeComparison::Bin& bin : comparison.measured) {
    PlotPoint p;
    p.x = degrees(bin.alpha);
    p.y = bin.mean;
    p.band = {{std::max(kFloor, bin.mean - bin.spread), bin.mean + bin.spread}};
    // No target: all of them are of the selected highlight, and a ring around each would hide the curves.
    p.label = formatted("alpha %.3g°: %.3g of the peak\nspread %.2g over %d pixels", p.x, p.y, bin.spread, bin.pixels);
    measured.points.push_back(std::move(p));
  }
  return measured;
}

PlotSeries curveOf(const LobeComparison& comparison, std::size_t place) {
  const LobeMatch& match = comparison.matches[place];
  PlotSeries curve;
  curve.name = lobeText(comparison, place);
  curve.colour = lobeStyle(place).colour;
  curve.dash = lobeStyle(place).dash;
  curve.width = int(place) == comparison.best ? 2.2 : 1.5;
  for (std::size_t i = 0; i < match.profile.size(); ++i) {
    PlotPoint p;
    p.x = degrees(comparison.measured[i].alpha);
    p.y = match.profile[i];
    p.label = curve.name + formatted("\nalpha %.3g°: %.3g of the peak", p.x, p.y);
    curve.points.push_back(std::move(p));
  }
  return curve;
}

}  // namespace

PlotData lobesPlot(const FrameSamples& samples, int highlight) {
  PlotData plot;
  plot.id = "lobes";
  plot.title = "Every lobe" + (samples.frameId.empty() ? "" : ", frame " + samples.frameId);
  plot.x.title = "alpha (°)";
  plot.y.title = "radiance / peak";
  if (!samples.failure.empty()) return nothing(plot, samples.failure);
  const FrameSamples::Lobe* const lobe = lobeOfHighlight(samples, highlight);
  if (!lobe) return nothing(plot, "No highlight in this frame");
  if (!lobe->comparison)
    return nothing(plot, "No lobe: " + (lobe->failure             ? lobe->failure->message()
                                        : lobe->comparisonFailure ? lobe->comparisonFailure->message()
                                                                  : std::string("nothing sampled")));
  const LobeComparison& comparison = *lobe->comparison;
  plot.x.from = 0;
  plot.y.log = true;
  plot.y.floor = kFloor;
  plot.series.push_back(measuredSeries(comparison));  // below the curves, which it would hide
  for (std::size_t k = 0; k < comparison.matches.size(); ++k) plot.series.push_back(curveOf(comparison, k));
  if (lobe->level > 0 && lobe->level < 1 && !comparison.measured.empty()) {
    PlotSeries level;
    level.name = formatted("level %.3g", lobe->level);
    level.colour = kHeldOut;
    level.dash = Dash::Dotted;
    level.width = 1.5;
    level.inLegend = false;  // its tip says what it is; a narrow plot has no room
    for (const double x : {0.0, degrees(comparison.measured.back().alpha)}) {
      PlotPoint p;
      p.x = x;
      p.y = lobe->level;
      p.label = formatted("contour level %.3g of the peak", lobe->level);
      level.points.push_back(p);
    }
    plot.series.push_back(std::move(level));
  }
  if (comparison.clipped > 0) plot.title += formatted(", %d clipped pixels left out", comparison.clipped);
  return plot;
}

}  // namespace glint::draw
