// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <map>
#include <string>

#include "core/pipeline/inspection.h"
#include "tests/core/properties/random_scene.h"

namespace glint::testing_support {

/// How the answer of a changed scene is brought back: world point -> scale (linear point + shift), pixel -> (sign u, v) / zoom + offset.
struct Back {
  Eigen::Matrix3d linear = Eigen::Matrix3d::Identity();
  Eigen::Vector3d shift = Eigen::Vector3d::Zero();
  double scale = 1;
  Pixel pixelFactor{1, 1}, pixelOffset{0, 0};
  Eigen::Vector3d point(const Eigen::Vector3d& p) const { return scale * (linear * p + shift); }
  Pixel pixel(const Pixel& p) const { return pixelFactor.cwiseProduct(p) + pixelOffset; }
};

/// Largest differences, by "model: quantity". Lights and ellipsoids are relative to their distance and size, contours and errors in px of
/// the first scene.
struct Differences {
  std::map<std::string, double> worst;
  std::map<std::string, std::string> where;  ///< of each, which scene and frame
  int fits = 0, contours = 0;                ///< how many were compared
  std::map<std::string, int> answered;       ///< fits by model
};

/// Compares the answer for a scene with that for a changed one; what one of them answers and the other refuses is a test failure. Frames
/// are found by their ids.
void compare(const Inspection& a, const Inspection& b, const Back& back, const std::string& scene, Differences& differences);

}  // namespace glint::testing_support
