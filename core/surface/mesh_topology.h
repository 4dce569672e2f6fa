// SPDX-License-Identifier: BSD-3-Clause
#pragma once

// Internal to core/surface: what a triangle soup needs before it is a surface.

#include <optional>
#include <vector>

#include "core/surface/surface.h"

namespace glint {

struct MeshTopology {
  std::vector<char> alive;                  ///< 0: degenerate or a repeat, ignored by all queries
  std::vector<char> turned;                 ///< 1: the winding is opposite to the majority of its connected part
  std::vector<Eigen::Vector3i> neighbours;  ///< [k]: across the edge from corner k to corner k + 1; -1 at borders
};

/// Welds equal positions, drops degenerate and repeated triangles, joins neighbours across edges that exactly two
/// triangles share, orients connected parts.
MeshTopology topologyOf(const TriangleMesh& mesh);

/// Unit vertex normals: those given where finite and not zero, else angle-weighted means of the oriented triangles around
/// the position; (0, 0, 0) where no triangle with an area is near.
std::vector<Eigen::Vector3d> vertexNormals(const TriangleMesh& mesh, const MeshTopology& topology);

/// For a mesh whose parts are all closed: the largest angle between the outward normal of a triangle and the normal at one of its
/// corners, rad. Outward is away from the volume that a connected part encloses. From outside of the mesh's box a triangle is
/// seen only where its outward normal faces the eye, unless the part turns inside out where it passes through itself. Nothing for
/// a mesh with a border, an edge of more than two triangles, or no orientation.
/// @param normals  unit, of the vertices
std::optional<double> outwardDeviation(const TriangleMesh& mesh, const MeshTopology& topology,
                                       const std::vector<Eigen::Vector3d>& normals);

}  // namespace glint
