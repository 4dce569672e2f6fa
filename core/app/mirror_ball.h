// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <Eigen/Core>
#include <optional>
#include <span>
#include <vector>

#include "core/app/ball_observation.h"
#include "core/base/outcome.h"
#include "core/geometry/camera.h"

// A mirror ball before one fixed camera. Axes are the camera's: x right, y down, z forward.
namespace glint {

/// How the balls are seen. With a camera, which is at the origin, lengths are in radii of the ball. Without one the rays are
/// parallel to z and lengths are pixels: x and y of a point are its pixel.
struct BallProjection {
  std::optional<Camera> camera;  ///< ideal pixels; pose and image size do not count

  /// Unit direction from a point towards the camera.
  Eigen::Vector3d toCamera(const Eigen::Vector3d& point) const {
    return camera ? Eigen::Vector3d(-point.normalized()) : Eigen::Vector3d(0, 0, -1);
  }
  Pixel project(const Eigen::Vector3d& point) const;
};

/// A sphere in the lengths of its view.
struct MirrorBall {
  Eigen::Vector3d centre = Eigen::Vector3d::Zero();
  double radius = 1;
};

/// A lamp at `direction / inverseDistance` from a point of reference: regular at infinity, where the inverse distance is 0.
struct AimedLamp {
  Eigen::Vector3d direction = -Eigen::Vector3d::UnitZ();  ///< unit, from the reference
  double inverseDistance = 0;                             ///< 1 / length of the view; negative beyond infinity
  Eigen::Vector3d reference = Eigen::Vector3d::Zero();

  /// Along the way from a point to the lamp; of no particular length.
  Eigen::Vector3d from(const Eigen::Vector3d& point) const { return direction - inverseDistance * (point - reference); }
};

/// A ball by three numbers of its image, px: with a camera the pixel of its centre and the focal length over the depth in radii;
/// else centre and radius of its outline.
MirrorBall ballOf(const BallProjection& view, const Eigen::Vector3d& parameters);

/// Those numbers and their covariance from the outline of the ball. With a camera the outline is the cone of rays that touch the
/// ball, sin(angle to its centre) = radius / distance, fitted to the points of the edge, or without any to the circle. The
/// covariance is larger than that of independent points by the same excess as the outline's own.
/// @return  NotConverged if no ball before the camera has this outline; NotFinite.
struct BallParameters {
  Eigen::Vector3d value = Eigen::Vector3d::Zero();
  Eigen::Matrix3d covariance = Eigen::Matrix3d::Zero();  ///< px^2
};
Outcome<BallParameters> ballParameters(const BallProjection& view, const RefinedOutline& outline);

/// Points of the outline of such a ball, ideal px, once around: the circle, or where rays from the camera touch the ball.
/// @param points  at least 3. Empty if the camera is in the ball or a ray that touches it does not come forward.
std::vector<Pixel> outlinePixels(const BallProjection& view, const Eigen::Vector3d& parameters, int points);

/// What the reflection law says of one peak.
struct MirrorRay {
  Eigen::Vector3d origin = Eigen::Vector3d::Zero();     ///< on the ball
  Eigen::Vector3d direction = Eigen::Vector3d::Zero();  ///< towards the lamp, unit
};
/// PeakOffSurface where the pixel's ray misses the ball.
Outcome<MirrorRay> mirrorRay(const BallProjection& view, const MirrorBall& ball, const Pixel& peak);

/// Where the ball mirrors the lamp: the root of 2 t = angle to the camera + angle to the lamp in the plane of the ball's centre,
/// camera and lamp, t the angle of the normal there (Alhazen's problem). Nothing if the lamp lies behind the ball.
std::optional<Pixel> mirrorPixel(const BallProjection& view, const MirrorBall& ball, const AimedLamp& lamp);

/// The lamp where the rays of several balls meet, or their common direction: least squares of the angles' sines, homogeneous.
/// @param reference  of the answer. @param scale  a length of the arrangement, such as the distance of the balls.
AimedLamp lampOfRays(std::span<const MirrorRay> rays, const Eigen::Vector3d& reference, double scale);

}  // namespace glint
