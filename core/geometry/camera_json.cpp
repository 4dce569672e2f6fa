// SPDX-License-Identifier: BSD-3-Clause
#include "core/geometry/camera_json.h"

#include <algorithm>
#include <cctype>
#include <cmath>
#include <numbers>
#include <string>
#include <vector>

#include "core/base/bounded_json.h"
#include "core/base/limits.h"
#include "core/geometry/transforms.h"

namespace glint {

namespace {

/// Keys that other programs write and that would move what a camera sees or where a surface is: to keep them and go on would
/// answer for another scene. Matched without regard to case.
const std::set<std::string> kCameraGeometry = {"k1",           "k2",          "k3",           "k4",           "k5",
                                               "k6",           "p1",          "p2",           "s1",           "s2",
                                               "s3",           "s4",          "omega",        "fov",          "shear",
                                               "alpha_c",      "aspect",      "aspect_ratio", "pixel_aspect", "distortion_model",
                                               "camera_model", "projection",  "fisheye",      "crop",         "crop_x",
                                               "crop_y",       "offset_x",    "offset_y",     "binning",      "scale",
                                               "rotation",     "orientation", "shift_x",      "shift_y",      "rolling_shutter"};
const std::set<std::string> kFrameGeometry = {"world_from_camera",
                                              "camera_to_world",
                                              "world_to_camera",
                                              "transform_matrix",
                                              "transform",
                                              "pose",
                                              "scale",
                                              "time_offset",
                                              "object_from_world",
                                              "camera_from_object",
                                              "world_from_surface",
                                              "surface_from_world",
                                              "undistorted"};

}  // namespace

void refuseGeometry(const JsonNode& node, const std::set<std::string>& keys) {
  for (const std::string& key : node.keys()) {
    std::string lower = key;
    std::transform(lower.begin(), lower.end(), lower.begin(), [](unsigned char c) { return char(std::tolower(c)); });
    if (keys.count(lower)) node.at(key).fail("is not supported and would change the geometry");
  }
}

void refuseFrameGeometry(const JsonNode& frame) { refuseGeometry(frame, kFrameGeometry); }

namespace {

LensModel readLensModel(const JsonNode& node) {
  const std::string name = node.text();
  if (const std::optional<LensModel> model = lensModelNamed(name)) return *model;
  std::string known;
  for (const LensModel model : kLensModels) known += std::string(known.empty() ? "" : ", ") + nameOf(model);
  node.fail("'" + name + "' is not supported, only " + known);
}

/// "model" and "distortion" of a camera; ideal without both.
Lens readLens(const JsonNode& camera) {
  Lens lens;
  if (const auto model = camera.find("model")) lens.model = readLensModel(*model);
  const auto distortion = camera.find("distortion");
  if (!distortion) return lens;
  const std::vector<double> values = boundedAll(*distortion, kLargestFactor).numbers();
  const std::size_t count = static_cast<std::size_t>(parameterCountOf(lens.model));
  const bool withoutK3 = lens.model == LensModel::OpenCv && values.size() == 4;  // as OpenCV takes them
  if (values.size() != count && !withoutK3)
    distortion->fail("must have " + std::to_string(count) + (count == 1 ? " number (" : " numbers (") + parametersOf(lens.model) +
                     "), has " + std::to_string(values.size()));
  std::copy(values.begin(), values.end(), lens.parameters.begin());
  if (lens.model == LensModel::Fov && !(std::abs(lens.parameters[0]) < std::numbers::pi))
    distortion->at(0).fail("must be between -pi and pi: omega is the lens's field of view");
  return lens;
}

}  // namespace

Camera readCameraJson(const JsonNode& node) {
  Camera camera;
  const auto size = [&](const char* key) {
    const JsonNode n = node.at(key);
    const int v = n.integer();
    if (v < 1 || v > 65536) n.fail("must be 1 .. 65536 pixels");
    return v;
  };
  camera.width = size("width");
  camera.height = size("height");
  constexpr double kMega = 1e6;
  requireWithin(Limit::ImageMegapixels, double(camera.width) * camera.height / kMega, node.file(), node.place());
  const auto focal = [&](const char* key) {
    const JsonNode n = node.at(key);
    const double v = n.number();
    if (!(v > 0)) n.fail("must be positive (K would be singular or mirrored)");
    return bounded(n, kFarthestPx);
  };
  // One by one: a failure inside a comma initialiser would leave it unfinished, and its destructor asserts.
  camera.pixelFromRay.setIdentity();
  camera.pixelFromRay(0, 0) = focal("fx");
  const auto skew = node.find("skew");
  camera.pixelFromRay(0, 1) = skew ? bounded(*skew, kFarthestPx) : 0.0;
  camera.pixelFromRay(0, 2) = bounded(node.at("cx"), kFarthestPx);
  camera.pixelFromRay(1, 1) = focal("fy");
  camera.pixelFromRay(1, 2) = bounded(node.at("cy"), kFarthestPx);
  refuseGeometry(node, kCameraGeometry);
  camera.lens = readLens(node);
  return camera;
}

Eigen::Isometry3d readPoseJson(const JsonNode& node, std::string* warning) {
  const Eigen::Matrix4d m = node.matrix4();
  for (std::size_t i = 0; i < 3; ++i) bounded(node.at(i).at(3), kFarthest);
  if (m.row(3) != Eigen::RowVector4d(0, 0, 0, 1)) node.fail("must be rigid: the last row must be 0 0 0 1");
  const TypedPose typed = typedPose(m.topLeftCorner<3, 3>(), m.topRightCorner<3, 1>());
  if (typed.rotation == TypedRotation::NotARotation) node.fail("must be rigid: the 3x3 block is not a rotation");
  if (typed.rotation == TypedRotation::Mirrored) node.fail("must be rigid: the 3x3 block is mirrored (determinant -1)");
  if (warning && typed.rotation == TypedRotation::Repaired)
    *warning = node.place() + ": not exactly a rotation, replaced by the nearest one";
  return typed.pose;
}

}  // namespace glint
