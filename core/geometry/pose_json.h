// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <Eigen/Geometry>
#include <string>

#include "core/base/json_text.h"

namespace glint {

/// 4x4 rigid transform: finite, last row 0 0 0 1, rotation orthonormal to 1e-3 and right-handed. A rotation that is off by more
/// than 1e-6 (printed with few digits) is replaced by the nearest one and `warning` says so.
Eigen::Isometry3d readPoseJson(const JsonNode& node, std::string* warning = nullptr);

}  // namespace glint
