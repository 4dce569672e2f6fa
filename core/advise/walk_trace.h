// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <vector>

#include "core/base/outcome.h"
#include "core/model/walk.h"

namespace glint {

/// One place of a walk of method.md section 6, for showing it. World, m.
struct WalkPlace {
  double distance = 0;                      ///< along the direction on T, m
  Eigen::Vector3d onTangentPlane{0, 0, 0};  ///< the walk's place on T
  Eigen::Vector3d position{0, 0, 0};        ///< its foot on S, orthogonal to T; in the walk on T the same as onTangentPlane
  Eigen::Vector3d normal{0, 0, 0};          ///< unit, towards the camera; in the walk on T always that of T
  double alpha = 0;                         ///< rad; NaN where the light or the camera is behind T
};

/// The two walks of one direction: on S until the limit angle, on T until the same angle.
struct WalkTrace {
  double azimuth = 0;                           ///< rad, in the tangent plane's basis
  double limitAngle = 0;                        ///< rad
  double reachOnSurface = 0, reachOnPlane = 0;  ///< m, distances along the direction on T
  std::vector<WalkPlace> onSurface, onPlane;    ///< equal steps of the distance, the first at P_B, the last at the limit
};

/// @param direction  of a canonical contour of this walk, without failure.
/// @param n  places of each walk, >= 2. Failure: that of the direction, or of the first foot that is missing.
Outcome<WalkTrace> traceWalk(const TangentWalk& walk, const Surface& surface, const DirectionResult& direction, int n);

}  // namespace glint
