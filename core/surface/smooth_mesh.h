// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <Eigen/Core>
#include <vector>

#include "core/surface/surface.h"

namespace glint {

/// A mesh whose vertices lie on quadrics that are fitted to the vertices around them.
struct SmoothMesh {
  TriangleMesh mesh;       ///< the same triangles; normals of the quadrics, else as given, else of the triangles around
  double noise = 0;        ///< of the given vertices across their quadrics, standard deviation, world units
  double normalNoise = 0;  ///< what is left of it in the normals, rad: median standard deviation of both angles together
};

/// Smooths a mesh that a scanner made. Each vertex moves along the mean normal around it onto a quadric over its tangent plane
/// (HeightQuadric), which is fitted to the vertices within a radius R with the weights w = (1 - (r/R)^2)^2, and takes its normal.
/// Vertices whose surroundings determine no quadric stay as they are: on lone triangles, and where R holds too few of them. Given
/// normals are not used. Borders stay borders. Vertices on the other side of a thin sheet do not count.
/// Many vertices in a small part of R count as their mean, so that the time does not grow with R.
class MeshSmoother {
 public:
  /// @param mesh  neighbours wound alike, as Surface::tessellate() of a mesh gives it
  explicit MeshSmoother(TriangleMesh mesh);
  /// Median length of an edge, world units; 0 without triangles.
  double spacing() const { return spacing_; }
  /// Diagonal of the box around the vertices.
  double size() const { return size_; }
  /// std::invalid_argument unless radius > 0.
  SmoothMesh at(double radius) const;

 private:
  TriangleMesh mesh_;
  std::vector<Eigen::Vector3d> areas_;  ///< per vertex: sum of its triangles' area vectors; zero on none
  Eigen::Vector3d corner_{0, 0, 0};
  double spacing_ = 0, size_ = 0;
};

}  // namespace glint
