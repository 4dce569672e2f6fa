// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <Eigen/Core>
#include <vector>

#include "core/base/outcome.h"
#include "core/geometry/camera.h"

namespace glint {

/// Point conic: x^T C x = 0 for homogeneous pixels x; an ellipse's interior is negative.
struct Conic {
  Eigen::Matrix3d matrix;
};
/// Line conic: l^T C* l = 0 for homogeneous lines l.
struct DualConic {
  Eigen::Matrix3d matrix;
};

/// An ellipse. Invariant: semiAxes.x() >= semiAxes.y() > 0; angle in (-pi/2, pi/2] is that of the
/// longer axis from +x towards +y (clockwise on the screen, because y is down).
struct Ellipse {
  Pixel centre;
  Eigen::Vector2d semiAxes;
  double angle = 0;

  Conic conic() const;       ///< x^T C x with interior negative, scaled so that the centre has value -1
  DualConic dual() const;    ///< C* = [c c^T - S, c ; c^T, 1] with the 2x2 shape S
  Pixel at(double t) const;  ///< centre + R (a cos t, b sin t)
  double area() const;
  /// n points at equal parameter steps, without repeating the first.
  std::vector<Pixel> sample(int n) const;
};

/// C* = C^-1 up to scale. RankDeficient if C has rank < 3 to round-off, judged from its centre where it has one
/// (so neither the unit of the pixel nor the distance from the origin matters).
Outcome<DualConic> dualOf(const Conic& c);
/// C = C*^-1 up to scale, sign such that an ellipse's interior is negative. RankDeficient if rank < 3.
Outcome<Conic> conicOf(const DualConic& c);

/// Real ellipse of a conic. RankDeficient for rank < 3; NotAnEllipse for hyperbola, parabola and imaginary
/// ellipse; NotFinite. The answer does not depend on the scale or sign of the matrix.
Outcome<Ellipse> toEllipse(const Conic& c);
Outcome<Ellipse> toEllipse(const DualConic& c);

/// Direct least-squares ellipse through n >= 5 points (unweighted, centred and whitened before the solve, which the
/// constraint allows), always an ellipse. Biased under noise: below 0.1 % of the axes on a whole contour with noise of 2 % of the
/// shorter axis, more on arcs (fit_ellipse_test.cpp).
/// TooFewPoints (< 5 distinct), RankDeficient (points on a line), NotFinite.
/// @see Halir and Flusser, Numerically stable direct least squares fitting of ellipses, WSCG 1998.
Outcome<Ellipse> fitEllipse(const std::vector<Pixel>& points);

/// The two lines through `point` (homogeneous pixels) that touch the conic, each normalised to |(a,b)| = 1.
/// NotAnEllipse if the point lies inside (no real tangents).
Outcome<std::array<Eigen::Vector3d, 2>> tangentLines(const Conic& c, const Eigen::Vector3d& point);

}  // namespace glint
