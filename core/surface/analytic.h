// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <Eigen/Core>
#include <Eigen/Geometry>
#include <map>
#include <memory>
#include <optional>
#include <string>

#include "core/surface/surface.h"

namespace glint {

/// One analytic surface of scene.json (docs/formats.md, "Analytic surfaces"). Field meaning depends on `type`; lengths in metres.
struct AnalyticSpec {
  std::string type;                         ///< plane, sphere, ellipsoid, cylinder, sheet, torus, quadric, or of a plugin
  double radius = 0;                        ///< sphere, cylinder (axis = local y)
  Eigen::Vector3d semiAxes{0, 0, 0};        ///< ellipsoid
  double curvature = 0;                     ///< sheet, 1/m, about local y, > 0 bends towards local -z; 0 = plane
  std::optional<double> length, width;      ///< sheet: along the arc, along local y; both centred at the local origin
  double majorRadius = 0, minorRadius = 0;  ///< torus, axis local z
  Eigen::Matrix4d matrix = Eigen::Matrix4d::Zero();  ///< quadric A, x^T A x = 0
  std::map<std::string, double> numbers;             ///< of a type that a plugin added (added_shape.h)
  Eigen::Isometry3d worldFromSurface = Eigen::Isometry3d::Identity();
};

/// The analytic surface of a specification. Stored normals: +z of plane and sheet (at the origin), outwards of sphere,
/// ellipsoid, cylinder and torus, along the gradient of x^T A x of a quadric.
/// std::invalid_argument for an unknown type, sizes that are not positive and finite, a pose that is not rigid,
/// minor radius > major radius (a self-intersecting torus), a zero quadric matrix.
std::shared_ptr<const Surface> makeAnalytic(const AnalyticSpec& spec);

}  // namespace glint
