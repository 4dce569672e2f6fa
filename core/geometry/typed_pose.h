// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <Eigen/Geometry>

namespace glint {

/// What a 3x3 matrix that somebody stored as a rotation is.
enum class TypedRotation { Exact, Repaired, NotARotation, Mirrored };

/// A rigid pose x -> R x + t from a matrix and a shift that were printed with few digits.
struct TypedPose {
  TypedRotation rotation = TypedRotation::NotARotation;
  Eigen::Isometry3d pose = Eigen::Isometry3d::Identity();  ///< of Exact and Repaired
};

/// NotARotation where a number is not finite or R^T R is off the identity by more than 1e-3, Mirrored where det R < 0. Else the nearest rotation is taken where R is
/// off enough to move a pixel; the camera's centre c, of R c + t = 0, stays. Repaired: R is none to single precision, either, which a person
/// should know.
TypedPose typedPose(const Eigen::Matrix3d& r, const Eigen::Vector3d& t);

}  // namespace glint
