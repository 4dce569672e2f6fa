// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <Eigen/Geometry>

#include "viz/frame_overlay.h"

namespace glint::viz {

/// The part of an overlay that lies in a rectangle of photograph pixels, for vector formats whose writer knows no clipping. A
/// line that leaves it becomes open pieces; marks are in or out by their place. Captions stay. What is wholly inside is
/// unchanged.
FrameOverlay cutTo(const FrameOverlay& overlay, const Eigen::AlignedBox2d& box);

}  // namespace glint::viz
