// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <Eigen/Core>
#include <Eigen/Geometry>

#include "core/base/outcome.h"
#include "core/geometry/camera.h"
#include "core/geometry/conic.h"

namespace glint {

/// Dual quadric Q* (planes): pi^T Q* pi = 0. Ellipsoid: Q* = [ c c^T - S , c ; c^T , 1 ] up to scale (method.md section 0).
struct DualQuadric {
  Eigen::Matrix4d matrix;
};

/// A solid ellipsoid, world units. Invariant: semi-axes finite, >= 0, in descending order, at most one of them 0.
class Ellipsoid {
 public:
  /// std::invalid_argument if the invariant cannot hold (semi-axes are sorted, the rotation with them).
  Ellipsoid(const Eigen::Isometry3d& worldFromBody, const Eigen::Vector3d& semiAxes);
  /// From centre and shape S (symmetric positive semidefinite, eigenvalues are squared semi-axes).
  /// NotAnEllipsoid if S has a negative eigenvalue (below -1e-12 of the largest) or more than one zero; NotFinite.
  static Outcome<Ellipsoid> fromCentreAndShape(const Eigen::Vector3d& centre, const Eigen::Matrix3d& shape);
  /// With Q* scaled so that (3,3) = +1 and c its last column: the same conditions on S = c c^T - Q*_3x3.
  /// NotAnEllipsoid also if (3,3) vanishes (an ellipsoid at infinity). Signature (3,1) alone would admit a hyperboloid.
  static Outcome<Ellipsoid> fromDual(const DualQuadric& dual);

  DualQuadric dual() const;
  Eigen::Vector3d centre() const { return worldFromBody_.translation(); }
  Eigen::Matrix3d shape() const;
  const Eigen::Isometry3d& worldFromBody() const { return worldFromBody_; }
  const Eigen::Vector3d& semiAxes() const { return semiAxes_; }

 private:
  Eigen::Isometry3d worldFromBody_;
  Eigen::Vector3d semiAxes_;
};

/// C* ~ P Q* P^T (Hartley and Zisserman, 2nd ed., result 8.9). Any quadric, any projection; no checks.
DualConic outline(const DualQuadric& quadric, const Projection& projection);

/// Outline of an ellipsoid as an ellipse in pixels. NotAnEllipse if it meets the plane through the camera centre
/// parallel to the image (its outline is then unbounded); BehindCamera if all of it is behind.
Outcome<Ellipse> outlineEllipse(const Ellipsoid& ellipsoid, const Projection& projection);

/// Counts of positive and negative eigenvalues, flipped so that (3,3) of the quadric is positive. By Sylvester's law they are
/// those of (3,3) and of -S, zero below 1e-12 of the largest of S: independent of the unit of length. Messages use its name.
struct Signature {
  int positive = 0, negative = 0, zero = 0;
};
Signature signatureOf(const DualQuadric& quadric);
const char* describe(const DualQuadric& quadric);

}  // namespace glint
