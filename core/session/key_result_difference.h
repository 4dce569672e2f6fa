// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <string>

namespace glint {

/// Distance of two values of one key result, relative to the larger one plus a least size, so that a zero may be one that came
/// out as round-off: 1 px or 1 % for distances between contours and peaks, 1e-3 for the rest. 0 for two NaN, infinite for one.
/// @param keyResult  its name, as in KeyResults ("dual.contour_error_px.mean")
double keyResultDifference(const std::string& keyResult, double was, double is);

}  // namespace glint
