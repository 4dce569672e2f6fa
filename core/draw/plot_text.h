// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <string>
#include <utility>

#include "core/advise/lobe_comparison.h"
#include "core/draw/colours.h"
#include "core/draw/painter.h"
#include "core/draw/plot_data.h"
#include "core/pipeline/inspection.h"
#include "core/pipeline/summary.h"
#include "core/scene/frame_name.h"

namespace glint::draw {

// What the makers of plots have in common.

constexpr double kSmallestPct = 1e-6;  // what a logarithmic axis shows of an exact scene

/// A sentence in place of a plot.
inline PlotData nothing(PlotData plot, std::string why) {
  plot.series.clear();
  plot.empty = std::move(why);
  return plot;
}

/// For values of a model; of a poor fit named so, pale and dashed, as everywhere.
inline PlotSeries modelSeries(const std::string& model, bool poor, PlotShape shape) {
  PlotSeries series;
  series.name = poor ? model + ", poor" : model;
  series.colour = modelColour(model, poor);
  series.dash = poor ? Dash::Dashed : Dash::Solid;
  series.shape = shape;
  return series;
}

inline bool isPoor(const ModelResult& result) { return !reasonsOf(result).poor.empty(); }  ///< a fit of it is

/// The frame's name in the scene; its number without a scene.
inline std::string frameName(const Inspection& inspection, int frame) {
  return inspection.scene ? glint::frameName(*inspection.scene, frame) : std::to_string(frame);
}

/// A lobe's line in plots and over photographs: no model's colour, and told apart by the dash as well.
struct LobeStyle {
  Colour colour;
  Dash dash;
};

/// @param place  of the lobe in LobeComparison::matches
const LobeStyle& lobeStyle(std::size_t place);

/// "ggx, m = 0.1203, rms 0.61 %, best", or the reason why it is missing.
std::string lobeText(const LobeComparison& comparison, std::size_t place);

}  // namespace glint::draw
