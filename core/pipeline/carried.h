// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <Eigen/Geometry>
#include <memory>

#include "core/model/model.h"

namespace glint {

// Things in other coordinates (method.md section 16). `by` is rigid and leads from the coordinates that they have.

Camera carried(Camera camera, const Eigen::Isometry3d& by);
/// The surface itself is held, see movedTo(). Null stays null.
std::shared_ptr<const Surface> carried(std::shared_ptr<const Surface> surface, const Eigen::Isometry3d& by);
Light carried(const Light& light, const Eigen::Isometry3d& by);
Lamp carried(const Lamp& lamp, const Eigen::Isometry3d& by);
/// Camera and surface are carried, and what is seen is found again. The pixels stay.
TrainingView carried(const TrainingView& view, const Eigen::Isometry3d& by);
/// Everything but the uncertainty, which is left out.
LightEstimate carried(LightEstimate estimate, const Eigen::Isometry3d& by);
ModelFit carried(ModelFit fit, const Eigen::Isometry3d& by);
/// Its points and planes; pixels are the same.
void carry(Prediction& prediction, const Eigen::Isometry3d& by);

}  // namespace glint
