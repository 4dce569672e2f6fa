// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include "core/base/image.h"

namespace glint {

/// Adds the noise of a first Kinect to exact depth: pixels are mixed up by half a pixel, the disparity 351.3 / z (m) gets
/// Gaussian noise of a sixth of a pixel and is rounded, so that the error grows with z^2, and half of the pixels within two
/// pixels of an edge (a jump of the depth, or none) lose theirs. Real maps have further faults: errors that stay (lens,
/// distance), and loss on dark and shiny surfaces.
///
/// @param depth  one channel, m; 0 = none.
/// @param times  noise and step of the disparity are those times this; 0 = nothing changes.
/// @param seed   equal for equal noise, on every machine.
/// std::invalid_argument for more channels than one, or a factor that is negative or not finite.
/// @see Barron and Malik, Intrinsic Scene Properties from a Single RGB-D Image, CVPR 2013; Handa et al., A Benchmark for RGB-D
///   Visual Odometry, 3D Reconstruction and SLAM, ICRA 2014: z = 351.3 / floor(351.3 / z + N(0, 1/36) + 0.5).
void addKinectNoise(Image& depth, double times, unsigned seed);

}  // namespace glint
