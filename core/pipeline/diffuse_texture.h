// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <string>
#include <vector>

#include "core/pipeline/lobe_stage.h"

namespace glint {

/// Between the rejection of bright texture and everything that uses highlights (detect.texture; method.md section 1, "Texture
/// underneath"): frames whose photographs show print or grain on the surface get their highlights anew, over the diffuse light
/// that other views of the same surface points show. Frames of a surface are taken as textured where, in most of up to twelve
/// views that are spread over the sequence, the others explain at least half of the fine structure; smooth surfaces stay as
/// they are. What lies under a frame depends on those views' photographs alone, not on which frames were asked before.
/// @param frames  whose evidence was gathered, and is as detected. Throws Stopped.
void takeTextureOff(Inspection& inspection, const std::vector<int>& frames, const SurfaceOfFrame& surfaceOf,
                    const ProgressFn& progress);

/// Under how many of a fit's training frames texture was taken off; "" for none.
std::string takenOffRemark(const Inspection& inspection);

}  // namespace glint
