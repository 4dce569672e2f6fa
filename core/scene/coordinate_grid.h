// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <Eigen/Core>
#include <optional>
#include <vector>

namespace glint {

/// The steps in which coordinates lie because of how they were written.
struct CoordinateGrid {
  double spacing = 0;            ///< units of the coordinates: the widest of the three axes
  bool singlePrecision = false;  ///< the spacing of floats there; else decimal places of a text
};

/// Whether all coordinates lie on the grid of single precision, or of a text with few digits, and use it: also its last digit
/// varies, as it does when numbers were rounded to it and does not when a shape has round coordinates. Nothing for doubles
/// written in full, and for an axis along which nothing varies.
std::optional<CoordinateGrid> coordinateGrid(const std::vector<Eigen::Vector3d>& vertices);

}  // namespace glint
