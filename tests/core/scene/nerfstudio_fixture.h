// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <Eigen/Core>
#include <Eigen/Geometry>
#include <memory>
#include <string>

#include "core/scene/capture.h"
#include "tests/core/scene/scene_fixture.h"

namespace glint::testing_support {

inline const CaptureReader& nerfstudioReader() {
  static const std::unique_ptr<const CaptureReader> one = makeNerfstudioReader();
  return *one;
}

/// nerfstudio's ray through the middle of the pixel in column u, row v of an undistorted image (its cameras.py: a pixel stands at
/// column + 0.5, row + 0.5; the direction is R ((x - cx) / fx, -(y - cy) / fy, -1)).
inline Eigen::Vector3d rayOfNerfstudio(const Eigen::Matrix4d& transform, double fx, double fy, double cx, double cy, double u,
                                       double v) {
  const Eigen::Vector3d d((u + 0.5 - cx) / fx, -(v + 0.5 - cy) / fy, -1);
  return (transform.topLeftCorner<3, 3>() * d).normalized();
}

/// A camera at (1, 2, 3) whose axes are the world's: it looks along -z of the world, and up is +y.
inline const char* const kIdentityPose = "[[1,0,0,1],[0,1,0,2],[0,0,1,3],[0,0,0,1]]";

/// The smallest file: 64 x 48 pixels, principal point in the middle of the image.
inline std::string minimalTransforms() {
  return R"({"w": 64, "h": 48, "fl_x": 100, "fl_y": 120, "cx": 32, "cy": 24,
  "frames": [{"file_path": "images/a.png", "transform_matrix": )" +
         std::string(kIdentityPose) + "}]}";
}

inline Capture readText(const TemporaryFolder& folder, const std::string& text, const CaptureOptions& options = {}) {
  return nerfstudioReader().read(folder.write("transforms.json", text), options);
}
/// In a folder of its own, without images.
inline Capture readText(const std::string& text, const CaptureOptions& options = {}) {
  const TemporaryFolder folder;
  return readText(folder, text, options);
}
inline Camera cameraOf(const std::string& text) { return readText(text).views.at(0).camera; }

inline CaptureOptions originalWorld() {
  CaptureOptions options;
  options.world = "original";
  return options;
}

/// A cloud of two points.
inline const char* const kTwoPoints =
    "ply\nformat ascii 1.0\nelement vertex 2\nproperty float x\nproperty float y\nproperty float z\nproperty uint8 red\n"
    "end_header\n4 -2 1.5 255\n-1 0.25 8 0\n";

}  // namespace glint::testing_support
