// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <Eigen/Geometry>
#include <string>

#include "core/base/json_text.h"

namespace glint {

/// 4x4 rigid transform: finite, last row 0 0 0 1, the rest as typedPose takes it; `warning` says where a rotation was repaired.
Eigen::Isometry3d readPoseJson(const JsonNode& node, std::string* warning = nullptr);

}  // namespace glint
