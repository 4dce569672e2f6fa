// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <Eigen/Core>
#include <array>

#include "core/base/outcome.h"
#include "core/geometry/camera.h"
#include "core/geometry/conic.h"

namespace glint {

/// F of two projections with finite centres, real or mirrored: x2^T F x1 = 0 for the images of one point; F = [e2]x M2 M1^-1 with
/// M the left 3x3 blocks and e2 = M2 (C1 - C2). Scaled to |F| = 1. RankDeficient if the centres coincide (then there are no
/// epipolar lines) or when a left block is singular; NotFinite.
/// @see Hartley & Zisserman, Multiple View Geometry, 2nd ed., sec. 9.2.2.
Outcome<Eigen::Matrix3d> fundamentalMatrix(const Projection& first, const Projection& second);

/// One image of a pair of outlines. Lines are homogeneous with |(a, b)| = 1, in ideal pixels.
struct EpipolarView {
  Eigen::Vector3d epipole;                     ///< image of the other centre, homogeneous, |.| = 1; may lie at infinity
  std::array<Eigen::Vector3d, 2> tangents;     ///< through the epipole, touching this image's ellipse
  std::array<Pixel, 2> contacts;               ///< where they touch it
  std::array<Eigen::Vector3d, 2> transferred;  ///< epipolar lines here of the other image's tangents; i belongs to tangents[i]
  /// By how much transferred[i] misses this ellipse, px: positive when it passes outside, negative when it cuts. 0 for the
  /// outlines of one ellipsoid.
  std::array<double, 2> missPx{};
};

struct EpipolarTangents {
  EpipolarView first, second;
  double rmsPx() const;  ///< of the four misses
};

/// Tangent epipolar lines of a pair of ellipses (method.md section 14). A plane through both centres that touches an ellipsoid
/// touches its outlines in both images, so the tangents of one image are carried to tangents of the other by l2 ~ F [e1]x l1.
/// Where they are not, no ellipsoid has both ellipses as outlines.
///
/// @param p1,p2  pixels from world; mirrored for virtual cameras.  @param e1,e2  ellipses in ideal pixels.
/// @return  NotAnEllipse if an epipole lies in its ellipse (the baseline meets the object: no tangents); as fundamentalMatrix.
/// @see Hartley & Zisserman, result 9.5; Porrill and Pollard, Curve matching and stereo calibration, IVC 1991 (tangency).
Outcome<EpipolarTangents> epipolarTangents(const Projection& p1, const Ellipse& e1, const Projection& p2, const Ellipse& e2);

}  // namespace glint
