// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include "core/base/image.h"
#include "core/geometry/camera.h"

namespace glint {

/// A depth map as another camera beside the depth camera sees it. Cells of four pixels are drawn as triangles, so that a finer
/// image has no holes. Where surfaces lie behind each other the nearest one stays. Cells across a jump of the depth are left out.
///
/// @param depth        one channel, m, of `depthCamera`'s size; not finite or <= 0 = none.
/// @param depthCamera  its camFromWorld is from the frame of `camera` (not from the world).
/// @param camera       gives size and lens of the result; its own pose is not used.
/// @param jump         relative depth difference that is an edge.
/// @return depth along the axis of `camera`, m, 0 = none.
Image registeredDepth(const Image& depth, const Camera& depthCamera, const Camera& camera, double jump = 0.05);

}  // namespace glint
