// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <string>
#include <vector>

#include "core/base/outcome.h"
#include "core/base/progress.h"
#include "core/pipeline/detect_settings.h"
#include "core/scene/scene.h"

namespace glint {

/// The contour level of a sequence.
struct LevelChoice {
  double level = 0.5;
  std::string reason;  ///< in words, with what was measured
  int looked = 0;      ///< frames with a highlight that were looked at
  int stable = 0;      ///< of them: the contour changes by no more than a lobe's does when the level changes by a tenth
  double noisePx = 0;  ///< median over these frames: what the pixels' noise moves the contour
};

/// Chooses the level for `detect.level`, one for all frames (method.md section 1): the scene's contours have theirs. Else
/// tries 0.5, 0.4, 0.6, 0.3, 0.7 on up to six frames, taking the first at which each frame's largest highlight is stable to a
/// tenth of the level (centre within 2 % of the longer semi-axis, axes like an ideal lobe's, Gaussian or GGX) and half a pixel
/// above noise; else the one at which most are. A clipped highlight lies at a fraction of the clip value, always below it.
/// @param frames  that are looked at, by index
/// @return  NoHighlight if none of them shows one; FrameUnreadable
Outcome<LevelChoice> chooseLevel(const Scene& scene, const std::vector<int>& frames, FrameSource source,
                                 const DetectSettings& settings, const ProgressFn& progress = {});

}  // namespace glint
