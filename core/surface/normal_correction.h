// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <Eigen/Core>
#include <memory>
#include <vector>

#include "core/surface/surface.h"

namespace glint {

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
