// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <optional>

#include "core/base/progress.h"
#include "core/scene/convention_report.h"
#include "core/scene/scene.h"

namespace glint {

/// Holds highlights of up to 24 frames against the lamps that the scene states as known (lights[].known): whether a highlight
/// lies where its lamp mirrors. If most do not, undoes likely mistakes one by one (directions reversed or turned by a quarter,
/// the wrong frame of coordinates, names off by one frame) and names the one that explains them. `hypotheses` hold the RMS angle
/// by which the peaks miss, degrees in place of pixels. Nothing where no frame has known lamps alone. Stopped; InputError
/// (unreadable surface).
std::optional<CameraCheck> checkKnownLamps(const Scene& scene, const ProgressFn& progress = {});

}  // namespace glint
