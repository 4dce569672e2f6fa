// SPDX-License-Identifier: BSD-3-Clause
#pragma once

// Internal to core/surface: triangles between points with normals.

#include <Eigen/Core>
#include <vector>

namespace glint {

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
