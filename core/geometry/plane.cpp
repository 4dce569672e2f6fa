// SPDX-License-Identifier: BSD-3-Clause
#include "core/geometry/plane.h"

#include <cmath>

namespace glint {

Eigen::Matrix4d Plane::reflection() const {
  Eigen::Matrix4d m = Eigen::Matrix4d::Identity();
  m.topLeftCorner<3, 3>() -= 2 * normal * normal.transpose();
  m.topRightCorner<3, 1>() = -2 * offset * normal;
  return m;
}

Eigen::Matrix<double, 3, 2> tangentBasis(const Eigen::Vector3d& n) {
  const double sign = std::copysign(1.0, n.z());
  const double a = -1.0 / (sign + n.z());
  const double b = n.x() * n.y() * a;
  Eigen::Matrix<double, 3, 2> basis;
  basis.col(0) << 1.0 + sign * n.x() * n.x() * a, sign * b, -sign * n.x();
  basis.col(1) << b, sign + n.y() * n.y() * a, -n.y();
  return basis;
}

Projection virtualCamera(const Camera& camera, const Plane& tangentPlane) {
  return {camera.projection().matrix * tangentPlane.reflection()};
}

}  // namespace glint
