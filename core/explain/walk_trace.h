// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <vector>

#include "core/base/outcome.h"
#include "core/model/walk.h"

namespace glint {

/// One step of the two walks of method.md section 6, for showing them.
struct WalkSample {
  double distance = 0;                      ///< along the direction on T, m
  Eigen::Vector3d onTangentPlane{0, 0, 0};  ///< world
  Eigen::Vector3d onSurface{0, 0, 0};       ///< foot of that point, orthogonal to T, world
  double alphaOnPlane = 0;                  ///< rad; NaN where the light or the camera is behind T
  double alphaOnSurface = 0;                ///< rad
};

/// The walk on S until the limit angle, then that on T until the same angle: both as far as the longer of the two reaches.
struct WalkTrace {
  double azimuth = 0;                           ///< rad, in the tangent plane's basis
  double limitAngle = 0;                        ///< rad
  double reachOnSurface = 0, reachOnPlane = 0;  ///< m, distances along the direction on T
  std::vector<WalkSample> samples;  ///< equal steps of the distance, the first at P_B; those beyond the end of S are left out
};

/// @param direction  of a canonical contour of this walk, without failure.
/// @param n  samples, >= 2. Failure: that of the direction.
Outcome<WalkTrace> traceWalk(const TangentWalk& walk, const Surface& surface, const DirectionResult& direction, int n);

}  // namespace glint
