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

}  // namespace glint
