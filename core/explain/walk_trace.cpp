// SPDX-License-Identifier: BSD-3-Clause
#include "core/explain/walk_trace.h"

#include <algorithm>

namespace glint {

Outcome<WalkTrace> traceWalk(const TangentWalk& walk, const Surface& surface, const DirectionResult& direction, int n) {
  require(n >= 2, "traceWalk: at least two samples");
  if (direction.failure) return *direction.failure;
  if (!direction.limitAngle) return Failure{Reason::NotReached, "the direction has no limit angle"};
  const Eigen::Vector3d start = walk.brightest().point.position, along = walk.direction(direction.azimuth),
                        normal = walk.tangentPlane().normal;
  WalkTrace trace;
  trace.azimuth = direction.azimuth;
  trace.limitAngle = *direction.limitAngle;
  trace.reachOnSurface = (direction.onSurface - start).dot(along);
  trace.reachOnPlane = (direction.onTangentPlane - start).dot(along);
  const double reach = std::max(trace.reachOnSurface, trace.reachOnPlane);
  SurfacePoint previous = walk.brightest().point;
  for (int i = 0; i < n; ++i) {
    WalkSample s;
    s.distance = reach * i / (n - 1);
    s.onTangentPlane = start + s.distance * along;
    const Outcome<SurfacePoint> foot =
        i == 0 ? Outcome<SurfacePoint>(previous) : surface.foot(s.onTangentPlane, normal, previous);
    if (!foot) break;
    const Outcome<double> alpha = walk.alphaOnSurface(*foot);
    if (!alpha) break;
    previous = *foot;
    s.onSurface = foot->position;
    s.alphaOnSurface = *alpha;
    s.alphaOnPlane = walk.alphaOnPlane(s.onTangentPlane);
    trace.samples.push_back(s);
  }
  return trace;
}

}  // namespace glint
