// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include "core/geometry/conic.h"
#include "core/model/reconstruct.h"

namespace glint::detail {

/// One view in normalised image and world coordinates: the ellipse's centre is the origin, its mean radius the unit, and the
/// world's origin lies at depth 1.
struct NormalisedView {
  Eigen::Matrix<double, 3, 4> projection;
  Eigen::Matrix<double, 6, 1> conic;  ///< vech of the dual conic, unit norm
};

/// Similarity world = origin + scale * normalised.
struct Normalisation {
  Eigen::Vector3d origin = Eigen::Vector3d::Zero();
  double scale = 1;
  std::vector<NormalisedView> views;
};

/// Half-vectorisation with sqrt(2) on the off-diagonal entries, so that its norm is Frobenius' (rotations of the image do not
/// change the weights): (00, 11, 22, 01, 02, 12).
Eigen::Matrix<double, 6, 1> vech(const Eigen::Matrix3d& m);
/// Symmetric matrix of coefficients in the same order, without the sqrt(2): S = sum_k s_k E_k.
Eigen::Matrix3d symmetric(const Eigen::Matrix<double, 6, 1>& s);

/// NotFinite when a view holds a NaN, infinity or an empty ellipse.
std::optional<Failure> check(const std::vector<ConicView>& views);
/// Unit of length such that the outlines, seen from `origin`, belong to an object of about unit size.
Normalisation normalise(const std::vector<ConicView>& views, const Eigen::Vector3d& origin);
/// Point nearest to the rays through the ellipses' centres; nothing when they are parallel or the projections have no centre.
std::optional<Eigen::Vector3d> axisPoint(const std::vector<ConicView>& views);
/// Contour points of a view: the measured ones, else samples of its ellipse.
std::vector<Pixel> contourOf(const ConicView& view);
/// RMS distance of each view's contour points to the outline; infinity where there is no elliptic outline.
std::vector<double> residuals(const std::vector<ConicView>& views, const Reconstruction& r);

}  // namespace glint::detail

namespace glint {

/// The foot of a point on an ellipse.
struct EllipseFoot {
  double distance;  ///< px, signed: positive outside
  Pixel point;      ///< nearest point of the ellipse
  Pixel normal;     ///< outward unit normal there
};

/// Nearest point of an ellipse, to round-off for any finite pixel: the root of a convex function, reached by Newton's method from
/// the side where it cannot overshoot. @see Eberly, Distance from a Point to an Ellipse, an Ellipsoid, or a Hyperellipsoid, 2013.
EllipseFoot footOnEllipse(const Ellipse& ellipse, const Pixel& p);

}  // namespace glint
