// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include "core/highlight/highlight.h"
#include "core/what_if/what_if.h"

namespace glint {

/// What a hand holds in a frame's picture.
enum class Held {
  Contour,      ///< the whole contour; the peak stays
  ContourSize,  ///< its distance from the centroid
  Peak,
  Camera  ///< what is under the hand stays under it: the camera turns about its centre
};

/// The changes after a hand moved from one place of a picture to another, on top of those it started from.
/// @param camera     of the frame, as the start has it
/// @param highlight  index in the frame's evidence, and `now` that highlight as the start has it; unused for Camera
/// @param from, to   ideal pixels
/// Places that give no finite change (the centroid as a handle of the size) change nothing.
WhatIf dragged(const WhatIf& start, Held held, int frame, const Camera& camera, int highlight, const Highlight& now,
               const Pixel& from, const Pixel& to);

/// A true light moved by a vector, world, m; one at infinity does not move.
WhatIf draggedLight(const WhatIf& start, const TrueLight& light, const Eigen::Vector3d& by);

}  // namespace glint
