// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <Eigen/Geometry>
#include <vector>

#include "core/pipeline/inspection.h"
#include "core/surface/surface.h"

namespace glint::draw {

/// Sizes that everything drawn in 3D is derived from, so that millimetres and kilometres look alike. World units.
struct SceneScale {
  Eigen::AlignedBox3d surfaceBox;  ///< the surface where it is bounded, else what the cameras see of it
  Eigen::AlignedBox3d sceneBox;    ///< surface and camera centres
  double surfaceSize = 1;          ///< diagonal of surfaceBox, > 0
  double sceneSize = 1;            ///< diagonal of sceneBox, > 0
  double cameraDepth = 0.1;        ///< from a camera's centre to its drawn image plane
  double lift = 1e-3;              ///< one step off the surface, so that what lies on it is not hidden in it
  double point = 1e-2;             ///< radius of a point
  double arrow = 0.1;              ///< length of a normal
};

/// @param surfaceBox  what is shown of the surfaces; empty where the cameras see none
/// @param frames      indices of those whose cameras are drawn
SceneScale sceneScale(const Inspection& inspection, const Eigen::AlignedBox3d& surfaceBox, const std::vector<int>& frames,
                      double glyphScale);
/// The same for one surface. @param surface may be null.
SceneScale sceneScale(const Inspection& inspection, const Surface* surface, const std::vector<int>& frames, double glyphScale);

}  // namespace glint::draw
