// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <optional>
#include <vector>

#include "core/draw/plot_places.h"

namespace glint::draw {

struct PlotStyle {
  bool dark = true;
  double scale = 1;  ///< device pixels per screen px
  friend bool operator==(const PlotStyle&, const PlotStyle&) = default;
};

/// The samples that a plot marks.
struct PlotMarks {
  std::vector<PlotSample> selected;
  std::optional<PlotSample> hovered;
};

/// Paints a plot over width x height device px, background included: title and legend at the top, then axes, grid, tinted ranges,
/// series, error bars, crosses and marks; or a dial; or the sentence that replaces it. In a low picture the legend ends
/// early, with dots. Every sample has its label as a hint.
/// @param shown   the part of the range to show
/// @return where the values lie; nothing if no plot was drawn
std::optional<PlotPlaces> paintPlot(Painter& painter, const PlotData& plot, const PlotStyle& style, const PlotRange& shown,
                                    const PlotMarks& marks, double width, double height);

}  // namespace glint::draw
