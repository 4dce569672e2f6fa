// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <Eigen/Core>
#include <Eigen/Geometry>
#include <optional>

#include "core/base/outcome.h"
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
  /// 90 degrees and more from the axis of a fisheye): the caller checks, or asks withoutDistortion,
  /// which names the reason. Near 90 degrees it lies far outside of width x height.
  Pixel undistorted(const Pixel& measured) const;
  /// Measured pixel of an ideal one (closed form). Not finite where the lens shows none, see distorted(Lens).
  Pixel distorted(const Pixel& ideal) const;
};

/// Ideal pixel of a measured one: the inverse of Camera::distorted, to 1e-14 of the image's size in normalised coordinates.
/// See undistorted(Lens) in core/geometry/lens.h.
/// @return  NotConverged if the lens shows no ideal pixel at `measured`; OutsideImage if a fisheye lens shows there what is
///          90 degrees or more from the axis, for which there is no ideal pixel; NotFinite.
Outcome<Pixel> withoutDistortion(const Camera& camera, const Pixel& measured);

/// The box of ideal pixels in which a photograph shows anything, with the outer edges of its outermost pixels: without distortion
/// [-0.5, width - 0.5] x [-0.5, height - 0.5]. A wide lens sees more than that, and its box has corners that it does not see. It
/// ends 85 degrees from the optical axis, where ideal pixels lose their meaning, and is never empty.
Eigen::AlignedBox2d seenWindow(const Camera& camera);

/// Whether an ideal pixel is in the photograph: its measured place is between the centres of the outermost pixels, or at most
/// `marginPx` beyond them; measured pixels. False if the lens shows none.
bool isInPhotograph(const Camera& camera, const Pixel& ideal, double marginPx = 0);

/// Whether an ideal pixel is measured on the border of the photograph, where contours that it cuts run: between the centres of
/// the outermost pixels and their outer edges, or as far inside.
bool onImageBorder(const Camera& camera, const Pixel& ideal);
/// Whether a piece of a contour runs along that border: it closes a contour that is cut there, and is no level set.
bool alongImageBorder(const Camera& camera, const Pixel& from, const Pixel& to);

/// A camera from a photograph's focal length on 35 mm film: the same angle of view across the diagonal (CIPA DC-008, tag 0xA405),
/// square pixels, central principal point, no distortion. Good to a few percent: EXIF rounds to millimetres, and lenses distort.
/// @param mm  above 0
inline Camera filmCamera(double mm, int width, int height) {
  constexpr double kFilmDiagonal = 43.2666;  // mm, of 36 x 24
  Camera camera;
  camera.width = width;
  camera.height = height;
  const double px = mm / kFilmDiagonal * Eigen::Vector2d(width, height).norm();
  camera.pixelFromRay << px, 0, (width - 1) / 2.0, 0, px, (height - 1) / 2.0, 0, 0, 1;
  return camera;
}

}  // namespace glint
