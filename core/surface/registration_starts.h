// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <Eigen/Core>
#include <Eigen/Geometry>
#include <memory>
#include <vector>

#include "core/surface/registration.h"

namespace glint {

/// Points spread evenly over the area of a mesh, with a search for the nearest ones. The points are always the same.
class MeshSamples {
 public:
  /// @pre some triangle has an area
  MeshSamples(const TriangleMesh& mesh, int count);
  const std::vector<Eigen::Vector3d>& points() const { return points_; }
  const std::vector<int>& triangles() const { return triangles_; }  ///< on which each one lies
  double area() const { return area_; }
  const Eigen::Vector3d& mean() const { return mean_; }
  double radius() const { return radius_; }  ///< root mean square distance from the mean
  /// Indices of about the `count` nearest samples to a point in the mesh's frame, the nearest first.
  std::vector<int> nearest(const Eigen::Vector3d& p, int count) const;

 private:
  struct Tree;
  std::vector<Eigen::Vector3d> points_;
  std::vector<int> triangles_;
  double area_ = 0, radius_ = 0;
  Eigen::Vector3d mean_ = Eigen::Vector3d::Zero();
  std::shared_ptr<const Tree> tree_;  // of centred and scaled samples
};

/// Where the mesh may lie, the most promising first; see registerMesh.
std::vector<Similarity> registrationStarts(const MeshSamples& mesh, const std::vector<SeenPoint>& points,
                                           const ProgressFn& progress);

}  // namespace glint
