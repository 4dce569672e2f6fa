// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <Eigen/Geometry>

#include "core/geometry/camera.h"

namespace glint {

/// The box of ideal pixels in which a photograph shows anything, with the outer edges of its outermost pixels: without distortion
/// [-0.5, width - 0.5] x [-0.5, height - 0.5]. A wide lens sees more than that, and its box has corners that it does not see. It
/// ends 85 degrees from the optical axis, where ideal pixels lose their meaning, and is never empty.
Eigen::AlignedBox2d seenWindow(const Camera& camera);

/// Whether an ideal pixel is in the photograph: its measured place is between the centres of the outermost pixels, or at most
/// `marginPx` beyond them; measured pixels. False if the lens shows none.
bool isInPhotograph(const Camera& camera, const Pixel& ideal, double marginPx = 0);

}  // namespace glint
