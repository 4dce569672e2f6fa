// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <Eigen/Core>
#include <algorithm>
#include <cmath>
#include <string>

#include "core/base/json_text.h"

namespace glint {

/// Range of a contour's level wherever one is given: a setting, a scene file, a synthetic scene.
inline constexpr double kLeastLevel = 1e-6, kMostLevel = 1 - 1e-6;

// Numbers of a scene within what its geometry can be computed for. Beyond, products of a few of them overflow, and the answer
// would be a failure of some later step instead of a line with the place. InputError (file, place).

inline constexpr double kFarthest = 1e15;       ///< metres, of any length or coordinate: a tenth of a light-year
inline constexpr double kFarthestPx = 1e9;      ///< pixels, of any coordinate or focal length
inline constexpr double kLargestFactor = 1e15;  ///< of lens distortion, curvatures and matrices, which have no unit of their own

/// The number, when its size is at most `most`.
inline double bounded(const JsonNode& node, double most) {
  const double v = node.number();
  if (!(std::abs(v) <= most)) {
    std::string text = std::to_string(static_cast<int>(std::round(std::log10(most))));
    node.fail("is larger than 1e" + text + " in size");
  }
  return v;
}
/// Every element of an array within the bound; returns the node, to be read.
inline const JsonNode& boundedAll(const JsonNode& node, double most) {
  for (std::size_t i = 0; i < node.size(); ++i) bounded(node.at(i), most);
  return node;
}
/// Above 0 and within the bound.
inline double positive(const JsonNode& node, double most) {
  const double v = node.number();
  if (!(v > 0)) node.fail("must be positive");
  return bounded(node, most);
}
/// A place or three lengths, metres.
inline Eigen::Vector3d lengths3(const JsonNode& node) { return boundedAll(node, kFarthest).vector3(); }
/// A place in an image.
inline Eigen::Vector2d pixel(const JsonNode& node) { return boundedAll(node, kFarthestPx).vector2(); }

/// A name of a frame, light or surface: not empty, no control characters.
inline bool isIdentifier(const std::string& id) {
  return !id.empty() &&
         std::none_of(id.begin(), id.end(), [](char c) { return static_cast<unsigned char>(c) < 0x20 || c == 0x7F; });
}

/// @throw InputError with file and place
inline std::string readIdJson(const JsonNode& node) {
  const std::string id = node.text();
  if (id.empty()) node.fail("must not be empty");
  if (!isIdentifier(id)) node.fail("must not contain control characters");
  return id;
}

}  // namespace glint
