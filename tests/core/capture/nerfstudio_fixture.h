// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <Eigen/Core>
#include <Eigen/Geometry>
#include <memory>

#include "core/capture/capture.h"

namespace glint::testing_support {

inline const CaptureReader& nerfstudioReader() {
  static const std::unique_ptr<const CaptureReader> one = makeNerfstudioReader();
  return *one;
}

/// nerfstudio's ray through the middle of the pixel in column u, row v of an undistorted image (its cameras.py: a pixel stands at
/// column + 0.5, row + 0.5; the direction is R ((x - cx) / fx, -(y - cy) / fy, -1)).
inline Eigen::Vector3d rayOfNerfstudio(const Eigen::Matrix4d& transform, double fx, double fy, double cx, double cy, double u,
                                       double v) {
  const Eigen::Vector3d d((u + 0.5 - cx) / fx, -(v + 0.5 - cy) / fy, -1);
  return (transform.topLeftCorner<3, 3>() * d).normalized();
}

}  // namespace glint::testing_support
