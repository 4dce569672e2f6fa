// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include "core/base/outcome.h"
#include "core/geometry/camera.h"

namespace glint {

/// Ideal pixel of a measured one: the inverse of Camera::distorted, to 1e-14 of the image's size in normalised coordinates.
/// See undistorted(Lens) in core/geometry/lens.h.
/// @return  NotConverged if the lens shows no ideal pixel at `measured`; OutsideImage if a fisheye lens shows there what is
///          90 degrees or more from the axis, for which there is no ideal pixel; NotFinite.
Outcome<Pixel> withoutDistortion(const Camera& camera, const Pixel& measured);

}  // namespace glint
