// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <Eigen/Geometry>
#include <set>
#include <string>

#include "core/base/json_text.h"
#include "core/geometry/camera.h"

namespace glint {

/// {"width", "height", "fx", "fy", "cx", "cy", "skew", "model", "distortion"}: intrinsics only, as scene files and lines of poses
/// write them. Sizes 1 .. 65536; fx, fy > 0, so K is regular. Keys that it does not know are left to the caller
/// (JsonNode::unknownKeys), except those that would bend or move the image.
/// @throw InputError with file and place
Camera readCameraJson(const JsonNode& node);

/// Refuses an object that has one of these keys, in lower or upper case: other programs write them, and to pass over them would
/// answer for another geometry.
/// @param keys  in lower case
/// @throw InputError at the key
void refuseGeometry(const JsonNode& node, const std::set<std::string>& keys);
/// The same for a frame: keys that state its pose otherwise than `camera_from_world` does.
void refuseFrameGeometry(const JsonNode& frame);

/// 4x4 rigid transform: finite, last row 0 0 0 1, the rest as typedPose takes it; `warning` says where a rotation was repaired.
Eigen::Isometry3d readPoseJson(const JsonNode& node, std::string* warning = nullptr);

}  // namespace glint
