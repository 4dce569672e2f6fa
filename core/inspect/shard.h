// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <memory>
#include <vector>

#include "core/base/shard.h"
#include "core/inspect/inspection.h"

namespace glint {

/// What `inspect` says about the frames of one shard: the same evidence, fits, predictions and comparisons, to the last bit, times aside.
/// Every shard makes the fits that its frames need, from the training frames; the images of other frames are read only where a light
/// cannot be told without them (several lights in a frame, a light that no training frame shows). Where every surface has its own fit,
/// a shard has whole surfaces and makes their fits alone. Failures as `inspect`.
Inspection inspectShard(std::shared_ptr<const Scene> scene, const InspectionRequest& request, const Shard& shard,
                        const ProgressFn& progress = {});

/// The frames that a shard predicts, in order: an equal share of all, or of the surfaces (numbered by their first frame) where every
/// surface has its own fit. Each frame is in exactly one shard.
/// @param inspection  its scene, surfaces and training frames; nothing computed yet
std::vector<int> framesOfShard(const Shard& shard, const Inspection& inspection);

/// Whether the other frames can add no light and no fit to what the gathered ones show, so that their images need not be looked at: every
/// light that a frame may show is one that a training frame shows. Where every surface has its own fit, of `frames` alone.
/// @param inspection  with the evidence of the training frames and of `frames`, as found
bool lightsKnownFrom(const Inspection& inspection, const std::vector<int>& frames);

/// Where every surface has its own fit: drops evidence and fits of surfaces that `frames` do not show, which were needed only to tell
/// the lights. Else nothing.
void keepOwnSurfaces(Inspection& inspection, const std::vector<int>& frames);

}  // namespace glint
