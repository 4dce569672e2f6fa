// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <algorithm>
#include <vector>

#include "core/geometry/light.h"
#include "core/surface/surface.h"

namespace glint {

/// A surface that answers many questions of occlusion together faster than one by one.
class ManyOcclusions {
 public:
  virtual ~ManyOcclusions() = default;
  /// Surface::occluded for every point towards one other point: 1 where it holds.
  virtual std::vector<char> occludedMany(const std::vector<SurfacePoint>& from, const Eigen::Vector3d& to) const = 0;
  /// Whether any of many points that lie close together is occluded. Faster where none is: a ray that slips through a
  /// vertex is not asked again, because its neighbours hit.
  virtual bool anyOccluded(const std::vector<SurfacePoint>& from, const Eigen::Vector3d& to) const = 0;
};

/// The same for any surface: in packets where it can, one by one elsewhere.
inline std::vector<char> occludedMany(const Surface& surface, const std::vector<SurfacePoint>& from, const Eigen::Vector3d& to) {
  if (const auto* many = dynamic_cast<const ManyOcclusions*>(&surface)) return many->occludedMany(from, to);
  std::vector<char> result(from.size());
  for (std::size_t i = 0; i < from.size(); ++i) result[i] = surface.occluded(from[i], to);
  return result;
}

/// Whether any of many points that lie close together is occluded.
inline bool anyOccluded(const Surface& surface, const std::vector<SurfacePoint>& from, const Eigen::Vector3d& to) {
  if (const auto* many = dynamic_cast<const ManyOcclusions*>(&surface)) return many->anyOccluded(from, to);
  return std::any_of(from.begin(), from.end(), [&](const SurfacePoint& p) { return surface.occluded(p, to); });
}

/// A world point beyond everything that could hide a light at infinity from `point`: twice the surface's size away. For an
/// unbounded surface, which has no size of its own, a thousand times `viewDistance`, the distance that it is seen from.
inline Eigen::Vector3d beyondSurface(const Surface& surface, const Eigen::Vector3d& point, const Eigen::Vector3d& direction,
                                     double viewDistance) {
  const Eigen::Vector3d extent = surface.bounds().sizes();
  return point + (extent.allFinite() ? 2 * extent.norm() + viewDistance : 1e3 * viewDistance) * direction;
}

/// Where occlusion of a light is tested to: the light, or `beyondSurface` when it is at infinity or farther than doubles reach.
inline Eigen::Vector3d occlusionTarget(const Surface& surface, const Eigen::Vector3d& point, const Light& light,
                                       double viewDistance) {
  if (!light.atInfinity()) {
    const Eigen::Vector3d position = light.position();
    if (position.allFinite()) return position;
  }
  return beyondSurface(surface, point, light.directionFrom(point), viewDistance);
}

}  // namespace glint
