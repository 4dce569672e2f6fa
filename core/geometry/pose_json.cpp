// SPDX-License-Identifier: BSD-3-Clause
#include "core/geometry/pose_json.h"

#include <Eigen/LU>
#include <Eigen/SVD>

#include "core/base/bounded_json.h"

namespace glint {

Eigen::Isometry3d readPoseJson(const JsonNode& node, std::string* warning) {
  const Eigen::Matrix4d m = node.matrix4();
  for (std::size_t i = 0; i < 3; ++i) bounded(node.at(i).at(3), kFarthest);
  if (m.row(3) != Eigen::RowVector4d(0, 0, 0, 1)) node.fail("must be rigid: the last row must be 0 0 0 1");
  Eigen::Matrix3d r = m.topLeftCorner<3, 3>();
  Eigen::Vector3d t = m.topRightCorner<3, 1>();
  const double deviation = (r.transpose() * r - Eigen::Matrix3d::Identity()).cwiseAbs().maxCoeff();
  // Typed with four digits it is still a rotation; worse, something else was meant. What is none to single precision is repaired.
  if (!(deviation <= 1e-3)) node.fail("must be rigid: the 3x3 block is not a rotation");
  if (r.determinant() < 0) node.fail("must be rigid: the 3x3 block is mirrored (determinant -1)");
  // Far from the origin even the tenth digit moves the camera (by deviation * |t|): the centre c of R c + t = 0 is kept. 1e-8 of the unit
  // of length moves no pixel.
  if (deviation > 1e-6 || deviation * t.norm() > 1e-8) {
    const Eigen::JacobiSVD<Eigen::Matrix3d> svd(r, Eigen::ComputeFullU | Eigen::ComputeFullV);
    const Eigen::Matrix3d rotation = svd.matrixU() * svd.matrixV().transpose();
    t = rotation * r.inverse() * t;
    r = rotation;
    // What is a rotation to single precision was meant to be one.
    if (warning && deviation > 1e-6) *warning = node.place() + ": not exactly a rotation, replaced by the nearest one";
  }
  Eigen::Isometry3d pose = Eigen::Isometry3d::Identity();
  pose.linear() = r;
  pose.translation() = t;
  return pose;
}

}  // namespace glint
