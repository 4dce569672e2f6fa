// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <functional>
#include <string>
#include <vector>

#include "core/base/progress.h"
#include "core/inspect/inspection.h"
#include "core/inspect/lobe_stage.h"

namespace glint {

/// Between detection and everything that uses its highlights: bright texture goes out of the evidence of these frames
/// (detect.motion, core/fit/highlight_motion.h).
/// @param frames  whose evidence was gathered, and is as detected
/// @param gather  gathers further frames that must be asked and judged. Not called while the present ones decide. Throws Stopped
void rejectTextures(Inspection& inspection, std::vector<int> frames, const SurfaceOfFrame& surfaceOf,
                    const std::function<void(const std::vector<int>&)>& gather, const ProgressFn& progress);

/// How much bright texture a fit's training frames show; "" without any.
std::string textureRemark(const Inspection& inspection);

}  // namespace glint
