// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <map>
#include <string>
#include <utility>
#include <vector>

#include "core/pipeline/inspection.h"
#include "tests/core/properties/random_scene.h"

namespace glint::testing_support {

/// How the answer of a changed scene is brought back: world point -> scale (linear point + shift), pixel -> (sign u, v) / zoom +
/// offset.
struct Back {
  Eigen::Matrix3d linear = Eigen::Matrix3d::Identity();
  Eigen::Vector3d shift = Eigen::Vector3d::Zero();
  double scale = 1;
  Pixel pixelFactor{1, 1}, pixelOffset{0, 0};
  Eigen::Vector3d point(const Eigen::Vector3d& p) const { return scale * (linear * p + shift); }
  Pixel pixel(const Pixel& p) const { return pixelFactor.cwiseProduct(p) + pixelOffset; }
};

enum class Quantity { Light, LimitAngle, Roughness, Centre, Shape, ContourPx, PeakPx, ErrorPx, EllipsePct, Iou };
constexpr int kQuantities = 10;
const char* nameOf(Quantity quantity);

/// Largest differences, by model and quantity. Lights (by distance), limit angles, roughness and ellipsoids (centre by distance,
/// shape by size) are relative, contours, peaks and errors in px of the first scene.
struct Differences {
  struct Worst {
    double difference = 0;
    std::string where;  ///< scene and frame
  };
  std::map<std::pair<std::string, Quantity>, Worst> worst;
  std::map<std::string, int> fits, contours;  ///< by model, how many were compared
};

/// Compares the answer for a scene with that for a changed one; what only one of them answers is a test failure. Ids find the
/// frames. @param models  only these; empty = all
void compare(const Inspection& a, const Inspection& b, const Back& back, const std::string& scene, Differences& differences,
             const std::vector<std::string>& models = {});

}  // namespace glint::testing_support
