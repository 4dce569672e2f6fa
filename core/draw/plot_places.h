// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <Eigen/Core>
#include <vector>

#include "core/draw/plot_data.h"

namespace glint::draw {

/// Where a plot's values lie in a picture of it: device px, (0, 0) = top left, y down.
struct PlotPlaces {
  PlotRange shown;                                  ///< the part of the range between the borders below
  double left = 0, right = 1, top = 0, bottom = 1;  ///< of the area with the values
  Eigen::Vector2d centre{0, 0};                     ///< of a dial
  double radius = 1;
  double scale = 1;            ///< device pixels per screen px
  std::vector<int> crossRows;  ///< row of each series' crosses, counted from the top; -1 without any

  double xOf(const PlotData& plot, double x) const;
  /// Not finite for a gap.
  Eigen::Vector2d place(const PlotData& plot, double x, double y) const;
  /// The same for a sample; that of one without a value is its cross.
  Eigen::Vector2d placeOf(const PlotData& plot, int series, const PlotPoint& point) const;
  bool inside(const PlotData& plot, const Eigen::Vector2d& place) const;
};

// A dial's circle of zero and how far the largest residual goes from it, in radii of the dial.
inline constexpr double kZeroRadius = 0.58, kReachOfDial = 0.36;

std::vector<int> crossRowsOf(const PlotData& plot);

}  // namespace glint::draw
