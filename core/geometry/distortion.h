// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include "core/base/outcome.h"
#include "core/geometry/camera.h"

namespace glint {

/// Ideal pixel of a measured one: the inverse of Camera::distorted, by a damped Newton's method to 1e-14 of the image's size in
/// normalised coordinates.
///
/// The Brown-Conrady model is a polynomial: far from the centre it folds back, and beyond the fold it shows nothing or shows it
/// twice. Only the branch that is connected with the centre is an answer.
/// @return  NotConverged where no ideal pixel of that branch is seen at `measured`; NotFinite.
/// @see Brown, Close-range camera calibration, 1971.
Outcome<Pixel> withoutDistortion(const Camera& camera, const Pixel& measured);

}  // namespace glint
