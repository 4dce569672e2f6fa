// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <Eigen/Core>

#include "core/geometry/camera.h"

namespace glint {

/// Oriented plane n.x + d = 0. Invariant: |normal| == 1.
struct Plane {
  Eigen::Vector3d normal;
  double offset;

  static Plane through(const Eigen::Vector3d& point, const Eigen::Vector3d& unitNormal) {
    return {unitNormal, -unitNormal.dot(point)};
  }
  double signedDistance(const Eigen::Vector3d& p) const { return normal.dot(p) + offset; }
  Eigen::Vector3d projected(const Eigen::Vector3d& p) const { return p - signedDistance(p) * normal; }
  /// Mirror image of a point.
  Eigen::Vector3d reflected(const Eigen::Vector3d& p) const { return p - 2 * signedDistance(p) * normal; }

  /// Eq. (mirror): M = [ I - 2 n n^T , -2 d n ; 0 , 1 ],  M M = I,  det M = -1.  method.md section 5 writes -d = n.p.
  Eigen::Matrix4d reflection() const;
};

/// Two unit vectors that complete a unit normal to a right-handed orthonormal basis (u, v, n).
/// Continuous except at one direction. @see Duff et al., Building an Orthonormal Basis, Revisited, JCGT 2017.
Eigen::Matrix<double, 3, 2> tangentBasis(const Eigen::Vector3d& unitNormal);

/// The camera that sees the world through a mirror: P_v = P M(plane). Determinant of the left block is
/// negative: a Projection, not a Camera. Pixels keep the photograph's orientation. method.md section 5.
Projection virtualCamera(const Camera& camera, const Plane& tangentPlane);

}  // namespace glint
