// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <Eigen/Core>
#include <vector>

namespace glint {

/// What a mesh file holds, as it was written: no coordinate passes through single precision unless the file stores it so.
/// Invariant: vertices are finite, there is at least one triangle, and its corners are indices of vertices.
struct MeshContent {
  std::vector<Eigen::Vector3d> vertices;
  /// One per vertex, unit, or zero where the file has none; empty if no triangle has one.
  std::vector<Eigen::Vector3d> normals;
  std::vector<Eigen::Vector3i> triangles;
  std::size_t leftOut = 0;  ///< facets of an STL with a corner that has no place
};

}  // namespace glint
