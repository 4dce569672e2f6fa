// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include "core/reflectance/lobe.h"

namespace glint {

/// The angle theta_h, rad, at which the lobe itself (D, or the cosine power) has fallen to `level` of its value in the mirror
/// direction. At most 1.4, where a lobe never falls that far.
/// @param roughness  m > 0. @param level  in (0, 1). std::invalid_argument otherwise.
double widthOf(Lobe lobe, double roughness, double level);

/// The m with which a lobe has a width: the inverse of widthOf, in closed form. Lobes of one width look alike near the level;
/// their m may differ by half. @param width  rad, in (0, pi / 2); for Phong widths beyond pi / 4 count as just below it.
double roughnessOf(Lobe lobe, double width, double level);

}  // namespace glint
