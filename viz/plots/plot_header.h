// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include "viz/plots/plot_data.h"

class vtkContext2D;

namespace glint::viz {

struct PlotHeaderStyle {
  Colour text{1, 1, 1}, faded{0.5, 0.5, 0.5};
  double scale = 1;  ///< device pixels per screen px
  bool dark = true;
};

/// How strongly a range of x is tinted, in the plot and in its legend.
double shadeOpacity(bool dark);

/// Title and legend at the top of a plot: its series, its tinted ranges, and what the crosses stand for. Returns their height,
/// device px. In a low picture the legend ends early, with dots. @param draw  else it is only measured. @param legend  else the
/// title alone.
double paintPlotHeader(vtkContext2D* painter, const PlotData& plot, const PlotHeaderStyle& style, double width, double height,
                       bool legend, bool draw);

/// A cross about a place, with a stroke of the background around it, so that it shows on lines and tints.
void paintCross(vtkContext2D* painter, const Eigen::Vector2d& at, double half, const Colour& colour, const Colour& around,
                double width);

}  // namespace glint::viz
