// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <vector>

#include "core/base/image.h"
#include "core/geometry/polyline.h"

namespace glint {

/// Sub-pixel iso-contours of a one-channel image: marching squares with linear interpolation on the float values.
struct IsoContour {
  Polyline line;               ///< closed; outer boundaries have positive signedArea, holes negative
  bool touchesBorder = false;  ///< part of it runs along the image border (through the centres of the border pixels)
};

/// All closed boundaries of { value >= level }, largest absolute area first. Regions cut by the image border are closed along it.
/// Where two opposite corners of a cell are inside and the others are not, the two are not joined. A contour starts at its first
/// point in the order of rows.
/// @param image  one channel, every value finite (std::invalid_argument otherwise).
/// @see Lorensen and Cline, Marching cubes, SIGGRAPH 1987.
std::vector<IsoContour> isoContours(const Image& image, double level);

/// What cutting off streaks did to a contour.
struct StreakCut {
  Polyline line;        ///< closed; untouched points keep their places to the last bit, cuts are straight
  double cutPx2 = 0;    ///< area that was cut off
  double radiusPx = 0;  ///< of the largest disc inside; 0 where the contour has no area
};

/// Cuts off narrow streaks of a contour: those of a clipped core, star bursts, grooves, reflections that lie along a
/// silhouette. The region is opened with a disc of a tenth of its largest inscribed one: where the contour runs farther from all
/// such discs than half their radius, it is replaced by a straight line. An ellipse is left alone up to an axis ratio of 20, and
/// so is every corner of 90 degrees or more. Pieces that hang together by a narrow neck stay together where both are large.
/// @param line  closed, px, as isoContours gives it
/// @return  the line as it was where nothing is narrow, or where the region is too thin to tell (largest disc below 2 px)
/// @see Serra, Image analysis and mathematical morphology, 1982 (opening).
StreakCut withoutStreaks(const Polyline& line);

/// Radius of the largest disc inside a closed line, px.
double largestDiscInside(const Polyline& line);

}  // namespace glint
