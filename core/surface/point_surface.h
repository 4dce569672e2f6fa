// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <Eigen/Core>
#include <string>
#include <vector>

#include "core/base/outcome.h"
#include "core/base/progress.h"
#include "core/surface/surface.h"

namespace glint {

/// Points without triangles, in metres and world coordinates.
struct PointCloud {
  std::vector<Eigen::Vector3d> points;
  std::vector<Eigen::Vector3d> normals;  ///< unit, one per point, or empty
};

struct PointSurfaceOptions {
  /// Points of a local fit; 0 = chosen by leaving points out: the more noise, the more points.
  int neighbours = 0;
  double largestHole = 3;  ///< radius of the largest circle without points that is closed, in units of the points' distance there
  double mostNormalSigmaDeg = 5;  ///< median over the points; beyond, a reflection is off by twice that: refused
};

/// What was made of the points, for reports. Lengths in metres.
struct PointSurfaceFacts {
  std::size_t points = 0;     ///< of the cloud
  std::size_t used = 0;       ///< on the surface; the others are alone, far off their neighbours, or repeat another
  double spacing = 0;         ///< median over the points: side of the square that each has for itself
  double noise = 0;           ///< standard deviation of the points across the surface, by leaving each out of its fit
  double normalSigmaDeg = 0;  ///< median standard deviation of the normals, from the fits' covariance
  int neighbours = 0;         ///< of a fit
  std::string text() const;   ///< one line
};

struct PointSurface {
  TriangleMesh mesh;  ///< with normals
  PointSurfaceFacts facts;
};

/// A surface from points: every point is moved onto a quadric that is fitted to its neighbours (moving least squares, one
/// projection), whose normal it takes; triangles join points that are neighbours in each other's tangent planes. Holes stay
/// holes: no triangle is larger than `largestHole` says. Noise below the distance of the points is smoothed away; the cloud needs
/// no normals; where it has them, points of the other side of a thin sheet are left out of a fit.
///
/// Fit: in the frame of the neighbours' plane, z = a + b x + c y + d x^2 + e x y + f y^2 by weighted least squares with
/// w = (1 - (r/h)^2)^2, h the distance of the last neighbour; the point becomes (0, 0, a), its normal (-b, -c, 1).
/// @see Alexa et al., Computing and Rendering Point Set Surfaces, IEEE TVCG 9(1), 2003. Levin, Mesh-independent surface
///   interpolation, 2004.
/// @return TooFewPoints: fewer than kFewestPoints, or too few that have neighbours; NotFinite; NoSurface: the normals are more
///         uncertain than `mostNormalSigmaDeg` (sparse points of a rough or noisy object), or nothing can be joined. Stopped.
Outcome<PointSurface> surfaceOfPoints(const PointCloud& cloud, const PointSurfaceOptions& options = {},
                                      const ProgressFn& progress = {});
inline constexpr std::size_t kFewestPoints = 50;  // a quadric has 6 unknowns, and leaving out needs several fits

// Internal to core/surface: triangles between points with normals.

/// Joins points that are Delaunay neighbours in each other's tangent planes. The star of a point there is the convex hull of its
/// neighbours after an inversion about it; a triangle is in up to three stars. Triangles of most stars come first, of those the
/// smallest; one that would be the third at an edge, or lie over one that is there, is left out.
/// @param normals     unit, one per point; their sides need not agree
/// @param neighbours  of every point: indices, the nearest first, without the point itself
/// @param largest     of every point: the largest radius of a triangle's circumcircle
/// @return corners; the winding of neighbours may differ
/// @see Adamy, Giesen and John, Surface reconstruction using umbrella filters, Computational Geometry 21, 2002.
std::vector<Eigen::Vector3i> trianglesBetween(const std::vector<Eigen::Vector3d>& points,
                                              const std::vector<Eigen::Vector3d>& normals,
                                              const std::vector<std::vector<int>>& neighbours,
                                              const std::vector<double>& largest);

}  // namespace glint
