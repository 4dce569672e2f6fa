// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cstddef>
#include <vector>

#include "core/geometry/camera.h"
#include "core/geometry/polyline.h"

namespace glint {

/// The nearest place on a closed predicted contour to a point of an observed one.
struct ContourFoot {
  double distance = 0;           ///< px, positive outside the predicted contour
  Pixel normal{0, 0};            ///< unit, outwards, of the predicted contour; not finite where it has none
  double arc = 0;                ///< arc length, as a share of the whole, in [0, 1]
  std::size_t from = 0, to = 0;  ///< vertices on both sides
  double share = 0;              ///< of the way from one to the other
};

/// One foot for every point; empty for a contour of fewer than three vertices.
std::vector<ContourFoot> feetOn(const Polyline& predicted, const std::vector<Pixel>& points);

/// Arc length at every vertex of a closed contour, as a share of the whole.
std::vector<double> arcOf(const Polyline& line);

}  // namespace glint
