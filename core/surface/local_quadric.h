// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include "core/surface/surface.h"

namespace glint {

/// The second-order patch of a surface at one point P with unit normal N and principal curvatures k1, k2 (directions d1, d2):
/// with x, y, z along d1, d2, N from P,
///   Eq. (quadric):  k1 x^2 + k2 y^2 + c z^2 + 2 z = 0,   1 + c z > 0,   c = the one of k1, k2 with the larger absolute value.
/// It has the surface's position, normal and curvatures at P; the term c z^2 is of fourth order and makes the patch exact on
/// planes, spheres and cylinders, where a paraboloid (c = 0) is not. All queries are closed forms: no ray is cast.
/// The patch is the one sheet through P, and ends where its normal is orthogonal to N.
class LocalQuadric final : public Surface {
 public:
  /// @param curvature  of the surface at `at`, with its signs for at.normal. std::invalid_argument unless all is finite.
  LocalQuadric(const SurfacePoint& at, const Curvature& curvature);

  /// The patch of a surface at one of its points; NotSupported where the surface has no curvature (facets).
  static Outcome<LocalQuadric> of(const Surface& surface, const SurfacePoint& at);

  std::string describe() const override { return "local quadric"; }
  Outcome<SurfacePoint> firstHit(const Ray& ray) const override;
  Outcome<SurfacePoint> foot(const Eigen::Vector3d& point, const Eigen::Vector3d& direction,
                             const SurfacePoint& previous) const override;
  Outcome<Curvature> curvatureAt(const SurfacePoint& p) const override;
  /// Always false: the patch knows only itself, and no part of a highlight on it hides another.
  bool occluded(const SurfacePoint&, const Eigen::Vector3d&) const override { return false; }
  /// Infinite: the patch is used near P only.
  Eigen::AlignedBox3d bounds() const override;
  /// A square of the tangent plane carried to the patch, as large as `region`.
  TriangleMesh tessellate(const Eigen::AlignedBox3d& region, int resolution) const override;

  const SurfacePoint& origin() const { return origin_; }
  const Eigen::Vector3d& curvatures() const { return k_; }  ///< k1, k2, c
  /// Columns d1, d2, N: world from patch, a rotation or a reflection.
  const Eigen::Matrix3d& worldFromPatch() const { return frame_; }

 private:
  SurfacePoint pointAt(const Eigen::Vector3d& local) const;

  SurfacePoint origin_;
  Eigen::Vector3d k_;
  Eigen::Matrix3d frame_;
};

}  // namespace glint
