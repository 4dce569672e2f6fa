// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <optional>
#include <vector>

#include "core/draw/painter.h"
#include "core/draw/plot_painter.h"

namespace glint::draw {

/// Colours and sizes of a plot on a dark or light background.
struct PlotLook {
  explicit PlotLook(const PlotStyle& style)
      : scale(style.scale),
        dark(style.dark),
        background(style.dark ? kDarkBackground : kLightBackground),
        text(style.dark ? kTextOnDark : kTextOnLight),
        faded(style.dark ? Colour{0.64, 0.66, 0.68} : Colour{0.36, 0.38, 0.41}),
        grid(style.dark ? Colour{0.24, 0.255, 0.275} : Colour{0.86, 0.87, 0.88}),
        around(style.dark ? kHalo : Colour{1, 1, 1}),
        shadeOpacity(style.dark ? 0.30 : 0.16) {}
  double px(double screen) const { return screen * scale; }
  double scale;  ///< device pixels per screen px
  bool dark;
  Colour background, text, faded, grid;
  Colour around;        ///< of rings and crosses, so that they show on lines and tints
  double shadeOpacity;  ///< of a tinted range of x
};

inline constexpr double kPlotFont = 12, kPlotSmallFont = 11;  // screen px

/// Title and legend at the top of a plot: its series, its tinted ranges, and what the crosses stand for. Returns their height,
/// device px. In a low picture the legend ends early, with dots. @param draw  false: only measures. @param legend  false: the
/// title alone.
double paintPlotHeader(Painter& painter, const PlotData& plot, const PlotLook& look, double width, double height, bool legend,
                       bool draw);

/// A cross about a place, with a stroke of the background around it.
void paintCross(Painter& painter, const Eigen::Vector2d& at, const Colour& colour, const PlotLook& look);
/// Around a sample of which PlotPoint::triangle is set.
void paintTriangle(Painter& painter, const Eigen::Vector2d& at, const Colour& colour, const PlotLook& look);

/// Where names are written that belong to points: beside their point, above to the right first, then below and to the left, then
/// in rows farther away; inside `area`, and never over one another or over a point. Nothing for a name without room.
/// @param widths  of the names, one for each point @param height  of a line @param scale  device pixels per screen px
std::vector<std::optional<Box>> notePlaces(const std::vector<Eigen::Vector2d>& points, const std::vector<double>& widths,
                                           double height, const Box& area, double scale);

}  // namespace glint::draw
