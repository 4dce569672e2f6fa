// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <Eigen/Geometry>

namespace glint {

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
