// SPDX-License-Identifier: BSD-3-Clause
#include "core/advise/walk_trace.h"

namespace glint {

Outcome<WalkTrace> traceWalk(const TangentWalk& walk, const Surface& surface, const DirectionResult& direction, int n) {
  require(n >= 2, "traceWalk: at least two places");
  if (direction.failure) return *direction.failure;
  if (!direction.limitAngle) return Failure{Reason::NotReached, "the direction has no limit angle"};
  const SurfacePoint& first = walk.brightest().point;
  const Eigen::Vector3d start = first.position, along = walk.direction(direction.azimuth), normal = walk.tangentPlane().normal;
  WalkTrace trace;
  trace.azimuth = direction.azimuth;
  trace.limitAngle = *direction.limitAngle;
  trace.reachOnSurface = (direction.onSurface - start).dot(along);
  trace.reachOnPlane = (direction.onTangentPlane - start).dot(along);
  SurfacePoint previous = first;
  for (int i = 0; i < n; ++i) {
    WalkPlace p;
    p.distance = trace.reachOnSurface * i / (n - 1);
    p.onTangentPlane = start + p.distance * along;
    if (i > 0) {
      const Outcome<SurfacePoint> foot = surface.foot(p.onTangentPlane, normal, previous);
      if (!foot) return foot.failure();
      const bool turned = foot->normal.dot(previous.normal) < 0;  // as the walk carries the side of the normal
      previous = *foot;
      if (turned) previous.normal = -previous.normal;
    }
    const Outcome<double> alpha = walk.alphaOnSurface(previous);
    if (!alpha) return alpha.failure();
    p.position = previous.position;
    p.normal = previous.normal;
    p.alpha = *alpha;
    trace.onSurface.push_back(p);
  }
  for (int i = 0; i < n; ++i) {
    WalkPlace p;
    p.distance = trace.reachOnPlane * i / (n - 1);
    p.onTangentPlane = p.position = start + p.distance * along;
    p.normal = normal;
    p.alpha = walk.alphaOnPlane(p.position);
    trace.onPlane.push_back(p);
  }
  return trace;
}

}  // namespace glint
