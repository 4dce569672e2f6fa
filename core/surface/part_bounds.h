// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <Eigen/Core>
#include <array>
#include <functional>
#include <optional>
#include <vector>

#include "core/surface/surface.h"

namespace glint {

/// One eye, one light, and the part of the image that counts.
struct MirrorQuery {
  Eigen::Vector3d eye;                   ///< world
  Eigen::Vector4d light;                 ///< homogeneous, w >= 0
  std::array<Eigen::Vector3d, 4> sides;  ///< unit, inward normals of the view's four planes, all through the eye
};

/// Eight parts of a surface at once, in single precision: what is certain of every point of each part.
using Eight = Eigen::Array<float, 8, 1>;
struct PartBounds {
  Eight tanSquared;    ///< tan^2 of the angle between N and H: at least this
  Eight cosView;       ///< N.V: at least this, and >= 0
  Eight cosHalf;       ///< cosine of half the angle between L and V: at least this, and >= 0
  Eight lightSquared;  ///< |l - w P|^2 for the homogeneous light (l, w): at least this
};

/// Makes, from the bounds of eight parts, an upper bound of what a field can reach above its level in each: parts with less than
/// 0 cannot reach it.
using PartTest = std::function<Eight(const PartBounds&)>;

/// A part of a surface that may reach a field's level.
struct SurfacePart {
  SurfacePoint middle;
  double radius = 0;  ///< every point of the part is within twice of this from `middle`
};

/// A surface that can bound a field part by part, without a ray.
class BoundedParts {
 public:
  virtual ~BoundedParts() = default;
  /// All parts inside the view that the test does not rule out and that the eye can see, and some that it cannot see.
  /// @param lightReach  how far the points of an extended light lie from query.light.head<3>(), in its homogeneous units.
  /// Nothing where the surface has no continuous normals, or when more than `most` parts remain.
  virtual std::optional<std::vector<SurfacePart>> partsThatMay(const MirrorQuery& query, double lightReach, const PartTest& test,
                                                               std::size_t most) const = 0;
};

/// Unit normals, inward, of the planes through the eye that bound the pixels between `min` and `max`.
std::array<Eigen::Vector3d, 4> sidesOf(const Camera& camera, const Pixel& min, const Pixel& max);

}  // namespace glint
