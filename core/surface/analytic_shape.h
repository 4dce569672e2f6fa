// SPDX-License-Identifier: BSD-3-Clause
#pragma once

// For core/surface and for plugins that add a shape (added_shape.h): one analytic shape in its own frame, as the zero set of an
// implicit function on a domain.

#include <Eigen/Core>
#include <Eigen/Geometry>
#include <memory>
#include <string>

#include "core/surface/analytic.h"
#include "core/surface/surface.h"

namespace glint {

/// Up to four intersections of a line with a shape, by parameter, ascending after `sort`.
struct LineRoots {
  double t[4];
  int count = 0;
  void add(double value) {
    if (count < 4) t[count++] = value;
  }
  void sort();
};

/// f(p) = 0 on a domain, local frame. Stored normals point along the gradient.
class AnalyticShape {
 public:
  virtual ~AnalyticShape() = default;
  virtual std::string describe() const = 0;
  virtual double value(const Eigen::Vector3d& p) const = 0;
  virtual Eigen::Vector3d gradient(const Eigen::Vector3d& p) const = 0;
  virtual Eigen::Matrix3d hessian(const Eigen::Vector3d& p) const = 0;
  /// Real roots of f(o + t d) for any sign of t, |d| = 1, without regard to the domain.
  virtual LineRoots roots(const Eigen::Vector3d& o, const Eigen::Vector3d& d) const = 0;
  virtual bool inDomain(const Eigen::Vector3d&) const { return true; }
  /// A length typical of the shape; infinity when it has none (an unbounded plane).
  virtual double size() const = 0;
  /// Bounding box after a rigid motion; infinite extents where unbounded.
  virtual Eigen::AlignedBox3d bounds(const Eigen::Isometry3d& worldFromLocal) const = 0;
  /// Grid of local points, row by row ((nu + 1) x (nv + 1)), that covers the part of the shape within `radius` of `centre`
  /// (infinite: all of it). Empty for shapes without a parametrisation; these are contoured instead.
  virtual std::vector<Eigen::Vector3d> grid(int nu, int nv, const Eigen::Vector3d& centre, double radius) const = 0;
  virtual bool bounded() const = 0;
};

/// std::invalid_argument as makeAnalytic.
std::unique_ptr<const AnalyticShape> makeShape(const AnalyticSpec& spec);

/// Zero set inside `localBox` by marching cubes on resolution^3 cells; vertices polished on f, local frame, no normals.
TriangleMesh contourShape(const AnalyticShape& shape, const Eigen::AlignedBox3d& localBox, int resolution);

/// Box with infinite extents.
Eigen::AlignedBox3d unboundedBox();

}  // namespace glint
