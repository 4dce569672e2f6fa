// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <Eigen/Core>

namespace glint {

/// x -> scale * rotation * x + translation: a frame and its unit seen from another one.
/// Invariant: scale > 0, rotation is one (det +1); the caller ensures it.
struct Similarity {
  double scale = 1;
  Eigen::Matrix3d rotation = Eigen::Matrix3d::Identity();
  Eigen::Vector3d translation = Eigen::Vector3d::Zero();

  Eigen::Vector3d operator*(const Eigen::Vector3d& x) const { return scale * (rotation * x) + translation; }
  /// First `other`, then this one.
  Similarity operator*(const Similarity& other) const {
    return {scale * other.scale, rotation * other.rotation, *this * other.translation};
  }
  Similarity inverse() const { return {1 / scale, rotation.transpose(), -(rotation.transpose() * translation) / scale}; }
};

}  // namespace glint
