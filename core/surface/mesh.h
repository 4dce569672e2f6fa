// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <Eigen/Core>
#include <memory>
#include <vector>

#include "core/surface/surface.h"

namespace glint {

/// A triangle mesh behind the Surface interface. Ray queries go through Embree in float32 on a centred and scaled copy;
/// every hit is then polished in double, moving to the neighbour triangle where the double hit lies outside
/// (RayPrecision::Double). With RayPrecision::Single Embree's hit is the answer: good to about 1e-7 of the mesh's size along the
/// ray. Feet reached by walking over neighbouring triangles are in double either way. Curved patches need the polishing and
/// ignore Single.
///
/// Normal policies (method.md section 2):
/// - Facet: flat positions, one normal per triangle (side of its winding after orientation). No curvature.
/// - Interpolated: flat positions, normalised linear interpolation of vertex normals: continuous, piecewise smooth.
/// - Curved: quadratic patch through the vertices and their tangent planes (Phong tessellation with weight 1/2, which
///   reproduces second-order surfaces to leading order), with the same continuous normals. Border edges bulge with the patch.
///   @see Boubekeur and Alexa, Phong Tessellation, SIGGRAPH Asia 2008.
///
/// Vertex normals are those of the mesh where they are finite and not zero, else angle-weighted means of the triangles around a
/// position (vertices with equal coordinates count as one). Neighbouring triangles of opposite winding are turned to
/// agree with the majority of their connected part. Degenerate triangles (zero area, repeated corners) and repeats of a
/// triangle are ignored by all queries but keep their index, so `element` always indexes `mesh.triangles`. Edges with more
/// than two triangles connect none of them.
/// curvatureAt: from the derivatives of the normal field inside the triangle; its sign refers to p.normal.
/// @param manySearches  the first search for brightest points builds a tree of normals (70 ms for a million triangles), which
///                      makes each search several times faster and surer; not worth it for a surface of one photograph
///
/// std::invalid_argument (with the index) for a vertex that is not finite or a corner out of range, when there is no
/// triangle with an area, or when the mesh's normals are neither empty nor one per vertex.
/// @param filled  one per vertex: not 0 = it was not measured (FilledParts); empty = all were measured.
std::shared_ptr<const Surface> makeMesh(TriangleMesh mesh, MeshPolicy policy, bool manySearches = true,
                                        std::vector<char> filled = {});

/// Wrong bumps of a surface, as a smooth height h along its stored normal: h(x) = sum of w_m exp(-|x - z_m|^2 /
/// (2 length^2)). It vanishes a few lengths away from all centres.
struct NormalCorrection {
  std::vector<Eigen::Vector3d> centres;  ///< z_m, world
  Eigen::VectorXd weights;               ///< w_m, world units
  double length = 1;                     ///< world units

  /// Gradient of h at a world point. Its part in the tangent plane is the angle, rad, by which the normal turns.
  Eigen::Vector3d gradientAt(const Eigen::Vector3d& x) const;
  bool changesAnything() const { return weights.size() > 0 && weights.any(); }
};

/// The mesh behind a surface with its vertices' normals turned, Eq. (turned): N' ~ N - (grad h - N (N.grad h)). Positions stay.
/// NotSupported for a surface without vertex normals (facets, shapes that do not tessellate without a region).
/// std::invalid_argument unless length > 0 and there is one weight per centre.
Outcome<std::shared_ptr<const Surface>> correctedMesh(const Surface& mesh, MeshPolicy policy, const NormalCorrection& correction);

}  // namespace glint
