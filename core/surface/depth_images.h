// SPDX-License-Identifier: BSD-3-Clause
#pragma once

// What happens to a depth image before it becomes a surface.
#include "core/base/image.h"
#include "core/geometry/camera.h"

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
