// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <optional>
#include <vector>

#include "core/base/progress.h"
#include "core/lamps/ball_photographs.h"

namespace glint {

/// Whether highlights are so wide that the middle of one is not its mirror point: a rough ball, no mirror.
bool showsLobes(const std::vector<LampObservation>& seen, const BallOutline& ball);

/// Refines the lamps of one rough ball by its lobe: fits every lamp in a scene with a sphere, as lampsOfScene()
/// does. A lamp takes the new direction if the model explains its highlight without doubt and agrees with the mirrored ray.
/// @param shots   with one ball. @param width,height  of its photographs
/// @param camera  see BallPhotographs; none: a camera so far away that its rays are parallel
/// @param lamps   of fitBallLamps(), in the order of the shots
void refineByLobe(const BallShots& shots, int width, int height, const std::optional<Camera>& camera, BallLamps& lamps,
                  const ProgressFn& progress);

}  // namespace glint
