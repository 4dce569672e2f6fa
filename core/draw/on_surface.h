// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <Eigen/Core>
#include <Eigen/Geometry>
#include <optional>
#include <vector>

#include "core/geometry/camera.h"
#include "core/geometry/conic.h"
#include "core/geometry/plane.h"
#include "core/geometry/polyline.h"
#include "core/pipeline/inspection.h"
#include "core/surface/surface.h"

// What a 3D picture shows of a photograph: pixels, contours and ellipses carried into the scene. World units throughout; the same
// for every program that draws.
namespace glint::draw {

using WorldChain = std::vector<Eigen::Vector3d>;

/// Where a ray meets a plane in front of its origin; nothing if it is parallel or behind.
std::optional<Eigen::Vector3d> intersection(const Ray& ray, const Plane& plane);
/// Ideal pixel of a frame carried onto the surface, lifted towards the camera by `lift`; nothing if the ray misses.
std::optional<Eigen::Vector3d> castPixel(const Camera& camera, const Surface& surface, const Pixel& pixel, double lift);
/// A contour on the surface: broken where it leaves the surface or jumps to another part of it. Points beyond those that can be
/// told apart on a screen are left out.
/// @param surfaceSize  diagonal of what is shown of the surface: a step of more than a tenth of it is a jump
std::vector<WorldChain> castContour(const Camera& camera, const Surface& surface, const Polyline& contour, double surfaceSize,
                                    double lift);
/// An image ellipse carried back to a plane, lifted towards the camera; broken where its rays do not meet the plane.
std::vector<WorldChain> ellipseOnPlane(const Camera& camera, const Plane& plane, const Ellipse& ellipse, double lift);
/// Radius of a disc on a tangent plane, so many times as wide as a contour (ideal pixels) there, within sizes that can be seen.
double planeRadius(const Camera& camera, const Plane& plane, const Eigen::Vector3d& at, const std::vector<Pixel>& contour,
                   double surfaceSize, double times);
/// What is shown of a surface: all of a bounded one; of another what the cameras see, from hits of a coarse grid of rays. Empty
/// where that is nothing.
Eigen::AlignedBox3d shownRegion(const Inspection& inspection, const Surface& surface, const std::vector<int>& frames);

}  // namespace glint::draw
