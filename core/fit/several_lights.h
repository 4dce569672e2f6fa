// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <functional>
#include <memory>
#include <vector>

#include "core/base/progress.h"
#include "core/fit/evidence.h"

namespace glint {

/// Some frame shows highlights whose light is not known from the frame alone: no frame's evidence is final before all are
/// gathered.
bool lightsNeedAllFrames(const Scene& scene);

/// Gives every highlight its light where several are on or none is stated (core/light/track.h), and brings the highlights of
/// one light in a frame to one level. Does nothing if every highlight has its light.
/// @param evidence     one per frame; changed in place
/// @param surfaceOf    of a frame; null if it has none
/// @param detectAgain  evidence of a frame with its lights kept apart; called from several threads
/// Throws Stopped.
void assignSeveralLights(const Scene& scene, std::vector<FrameEvidence>& evidence,
                         const std::function<std::shared_ptr<const Surface>(int frame)>& surfaceOf,
                         const std::function<FrameEvidence(int frame, const SeparateLights&)>& detectAgain,
                         const ProgressFn& progress);

}  // namespace glint
