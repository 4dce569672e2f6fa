// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <Eigen/Core>
#include <Eigen/Geometry>
#include <optional>

#include "core/geometry/lens.h"

namespace glint {

/// Pixels; (0, 0) is the centre of the top-left pixel, x right, y down.
using Pixel = Eigen::Vector2d;

/// A half line in the world. Invariant: |direction| == 1.
struct Ray {
  Eigen::Vector3d origin;
  Eigen::Vector3d direction;
  Eigen::Vector3d at(double t) const { return origin + t * direction; }
};

/// A general 3x4 projection: homogeneous pixels from homogeneous world points. It may be mirrored
/// (left 3x3 block with negative determinant), so it is not a rigid pose.
struct Projection {
  Eigen::Matrix<double, 3, 4> matrix;
  /// Pixel of a world point. The caller checks the depth; a point in the focal plane gives non-finite pixels.
  Pixel project(const Eigen::Vector3d& pointInWorld) const {
    const Eigen::Vector3d h = matrix * pointInWorld.homogeneous();
    return h.head<2>() / h.z();
  }
};

/// A calibrated camera. Axes: x right, y down, z forward (OpenCV).
/// Invariant: pixelFromRay is upper triangular with positive focal lengths and (2,2) == 1;
/// camFromWorld is rigid; width and height are positive.
struct Camera {
  Eigen::Matrix3d pixelFromRay = Eigen::Matrix3d::Identity();      ///< K: pixels from camera-frame rays
  Eigen::Isometry3d camFromWorld = Eigen::Isometry3d::Identity();  ///< R, t of pixel ~ K (R X + t)
  Lens lens;                                                       ///< ideal by default
  int width = 0, height = 0;

  Eigen::Vector3d centreInWorld() const;
  /// P = K [R | t], ideal pixels (no distortion).
  Projection projection() const;
  /// World ray through an ideal pixel, from the camera centre.
  Ray ray(const Pixel& idealPixel) const;
  /// Ideal pixel of a world point; nothing if it is not in front of the camera.
  std::optional<Pixel> project(const Eigen::Vector3d& pointInWorld) const;
  /// Depth along the optical axis, world units.
  double depth(const Eigen::Vector3d& pointInWorld) const;
  bool hasDistortion() const { return !lens.isIdeal(); }
  /// Ideal pixel of a measured (distorted) one. Not finite where no such pixel exists (beyond the fold of a strong distortion, or
  /// 90 degrees and more from the axis of a fisheye): the caller checks, or asks withoutDistortion (core/geometry/distortion.h),
  /// which names the reason. Near 90 degrees it lies far outside of width x height.
  Pixel undistorted(const Pixel& measured) const;
  /// Measured pixel of an ideal one (closed form). Not finite where the lens shows none, see distorted(Lens).
  Pixel distorted(const Pixel& ideal) const;
};

}  // namespace glint
