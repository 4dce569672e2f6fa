// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <Eigen/Core>
#include <Eigen/Geometry>
#include <compare>
#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "core/base/outcome.h"
#include "core/geometry/camera.h"

namespace glint {

/// How measured depth is smoothed before it becomes a surface.
/// None: as measured. Bilateral: weighted mean of inverse depths, near in the image and alike in depth (OpenCV). Fit: quadratic
/// in inverse depth, fitted to the neighbours on the same surface; it gives the normal as well.
enum class DepthSmoothing { None, Bilateral, Fit };
/// Plane: fitted to the neighbours within a radius (PCL). Integral: from integral images of the covariance, over a square of
/// pixels of that size (PCL).
enum class DepthNormals { Plane, Integral };

/// How a depth map becomes a surface. The defaults suit depth without noise.
struct DepthPolicy {
  DepthSmoothing smoothing = DepthSmoothing::None;
  DepthNormals normals = DepthNormals::Plane;
  /// Radius, m, of the neighbourhood that gives a point its normal and its smoothed depth; 0 = a share of the median depth.
  double radius = 0;
  int largestHolePx = 400;  ///< holes of at most this many pixels that touch no image border are filled; 0 = none
  int fusedFrames = 0;      ///< other frames whose depth is averaged in, where the object stands still
  double noise = 0;         ///< trials only: noise like that of a first Kinect is added, times this
  int seed = 1;             ///< of that noise

  auto operator<=>(const DepthPolicy&) const = default;
};

/// A point on a surface, world frame.
struct SurfacePoint {
  Eigen::Vector3d position;
  Eigen::Vector3d normal;             ///< unit; side as the surface stores it, see `facing`
  int element = -1;                   ///< triangle index on a mesh, -1 elsewhere
  Eigen::Vector2d barycentric{0, 0};  ///< on that triangle: weights of its second and third vertex
};

/// The same point with the normal on the side of `eye` (method.md section 0: N on the camera's side).
inline SurfacePoint facing(SurfacePoint p, const Eigen::Vector3d& eye) {
  if (p.normal.dot(eye - p.position) < 0) p.normal = -p.normal;
  return p;
}

/// Principal curvatures, 1/m; positive where the surface bends away from the stored normal (convex seen from there).
struct Curvature {
  double k1 = 0, k2 = 0;                   ///< k1 >= k2
  Eigen::Vector3d direction1, direction2;  ///< unit, tangent, orthogonal
};

/// Indexed triangles with vertex normals, for display and for seeds.
struct TriangleMesh {
  std::vector<Eigen::Vector3d> vertices;
  std::vector<Eigen::Vector3d> normals;  ///< one per vertex, unit, or empty
  std::vector<Eigen::Vector3i> triangles;
};

enum class NormalPolicy { Facet, Interpolated, Curved };
/// Double: single precision finds the triangle, double decides where on it. Single: the ray tracer's own answer.
enum class RayPrecision { Double, Single };

/// How a mesh answers, whatever it was made from. Analytic surfaces do not need it.
struct MeshPolicy {
  NormalPolicy normals = NormalPolicy::Interpolated;
  RayPrecision rays = RayPrecision::Double;
  DepthPolicy depth = {};  ///< of surfaces that are made from depth maps

  MeshPolicy() = default;
  MeshPolicy(NormalPolicy n, RayPrecision r = RayPrecision::Double, DepthPolicy d = {}) : normals(n), rays(r), depth(d) {}
  auto operator<=>(const MeshPolicy&) const = default;
};

/// What the method needs of a surface, whatever its source (analytic, mesh, depth map). Immutable; all
/// queries are const and may be called from several threads.
class Surface {
 public:
  virtual ~Surface() = default;
  virtual std::string describe() const = 0;

  /// First intersection of a ray with t > 0. NoHit; NotFinite.
  virtual Outcome<SurfacePoint> firstHit(const Ray& ray) const = 0;
  /// firstHit for many rays in one call, possibly in reduced precision (float, 1e-6 of the scene's size): for seeds and
  /// previews only. Missing hits are empty. The default calls firstHit.
  virtual std::vector<std::optional<SurfacePoint>> approximateHits(const std::vector<Ray>& rays) const;

  /// Foot of a point along a line: the intersection of { point + s direction, any sign of s } with the surface that
  /// lies nearest to `previous` (the foot of the step before, or the brightest point). Full double precision.
  /// SurfaceEnded when the line misses the surface near there.
  virtual Outcome<SurfacePoint> foot(const Eigen::Vector3d& point, const Eigen::Vector3d& direction,
                                     const SurfacePoint& previous) const = 0;

  /// Principal curvatures at a point of this surface. NotSupported on facets.
  virtual Outcome<Curvature> curvatureAt(const SurfacePoint& p) const = 0;

  /// Tangent that turns with the surface, unit, sign free: what brushed metal is rough along. The first direction of an
  /// analytic surface (around its y axis), else y x N; where N is within 1e-6 of y, the x axis, both of the world.
  virtual Eigen::Vector3d tangentAt(const SurfacePoint& p) const;

  /// True when the open segment between a surface point and another world point meets the surface.
  /// A neighbourhood of 1e-6 of the scene's size (or of the segment's length, if smaller) around `from` is ignored.
  virtual bool occluded(const SurfacePoint& from, const Eigen::Vector3d& to) const = 0;

  /// Bounding box; infinite extents for unbounded analytic types.
  virtual Eigen::AlignedBox3d bounds() const = 0;
  /// Triangles for display, clipped to `region` where the surface is unbounded; about `resolution` cells a side.
  virtual TriangleMesh tessellate(const Eigen::AlignedBox3d& region, int resolution) const = 0;
};

/// A surface that was not measured everywhere: holes in its depth were filled, so that contours can cross them.
class FilledParts {
 public:
  virtual ~FilledParts() = default;
  /// Whether the point lies on what was filled: a contour may pass there, but it is no evidence of where a peak is.
  virtual bool filledAt(const SurfacePoint& p) const = 0;
};

}  // namespace glint
