// SPDX-License-Identifier: BSD-3-Clause
#pragma once

// Similar and rigid transformations.
#include <Eigen/Core>
#include <Eigen/Geometry>

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

/// To the last bit.
inline bool isIdentity(const Eigen::Isometry3d& pose) { return pose.matrix() == Eigen::Isometry3d::Identity().matrix(); }

/// What kind of matrix was stored as a 3x3 rotation.
enum class TypedRotation { Exact, Repaired, NotARotation, Mirrored };

/// A rigid pose x -> R x + t from a matrix and a shift that were printed with few digits.
struct TypedPose {
  TypedRotation rotation = TypedRotation::NotARotation;
  Eigen::Isometry3d pose = Eigen::Isometry3d::Identity();  ///< of Exact and Repaired
};

/// NotARotation if a number is not finite or R^T R is off the identity by more than 1e-3; Mirrored if det R < 0. An R that is off
/// enough to move a pixel is replaced by the nearest rotation; the camera's centre c stays, where R c + t = 0. Repaired: R was no
/// rotation even to single precision, which a person should know.
TypedPose typedPose(const Eigen::Matrix3d& r, const Eigen::Vector3d& t);

}  // namespace glint
