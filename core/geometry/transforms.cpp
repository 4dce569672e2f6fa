// SPDX-License-Identifier: BSD-3-Clause
#include "core/geometry/transforms.h"

#include <Eigen/LU>
#include <Eigen/SVD>

namespace glint {

TypedPose typedPose(const Eigen::Matrix3d& r, const Eigen::Vector3d& t) {
  constexpr double kTyped = 1e-3;   // typed with four digits it is still a rotation; worse, something else was meant
  constexpr double kSingle = 1e-6;  // what is a rotation to single precision was meant to be one
  constexpr double kCentre = 1e-8;  // of the unit of length: moves no pixel
  const double deviation = (r.transpose() * r - Eigen::Matrix3d::Identity()).cwiseAbs().maxCoeff();
  TypedPose typed;
  if (!r.allFinite() || !t.allFinite() || !(deviation <= kTyped)) return typed;  // the largest coefficient passes over NaN
  if (r.determinant() < 0) return {TypedRotation::Mirrored, typed.pose};
  typed.rotation = deviation > kSingle ? TypedRotation::Repaired : TypedRotation::Exact;
  typed.pose.linear() = r;
  typed.pose.translation() = t;
  // Far from the origin even the tenth digit moves the camera, by deviation * |t|.
  if (deviation > kSingle || deviation * t.norm() > kCentre) {
    const Eigen::JacobiSVD<Eigen::Matrix3d> svd(r, Eigen::ComputeFullU | Eigen::ComputeFullV);
    typed.pose.linear() = svd.matrixU() * svd.matrixV().transpose();
    typed.pose.translation() = typed.pose.linear() * r.inverse() * t;
  }
  return typed;
}

}  // namespace glint
