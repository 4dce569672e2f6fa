// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <functional>
#include <string>
#include <vector>

#include "core/base/outcome.h"
#include "core/base/settings.h"
#include "core/pipeline/what_if.h"

namespace glint {

/// One number of a what-if, as a panel shows it.
struct WhatIfKnob {
  std::string group;                         ///< "Light lamp", "Camera of frame 0003", "Highlight 1 of frame 0003"
  ParamSpec spec;                            ///< key unique among the knobs; the default is the value that changes nothing
  bool synthetic = false;                    ///< counts only where contours are synthesised
  std::function<double(const WhatIf&)> get;  ///< in spec.unit
  std::function<void(WhatIf&, double)> set;  ///< a what-if whose knobs are all on their defaults is `none()` again
  int highlight = -1;                        ///< number of the frame's highlight, before edits by hand; -1 = of something else
};

/// Knobs for the lights (those with a position), the surface, the lobe, the camera and the highlights of one frame.
/// @param highlights  how many the frame's evidence has, with those made by hand (FrameEvidence::asFound).
/// @param roughness   m that a synthesis starts from, > 0: the default of that knob.
std::vector<WhatIfKnob> whatIfKnobs(const Scene& scene, int frame, int highlights, double roughness = WhatIf{}.roughness);

/// "contours synthesised, 1 light, 2 poses, 1 highlight"; "" for none.
std::string summaryOf(const WhatIf& whatIf);

/// What of a frame is not as it was captured, for the titles of its pictures: "contours and photograph synthesised, camera moved
/// by hand"; "" for a frame that nothing changes.
std::string frameNote(const WhatIf& whatIf, int frame);

}  // namespace glint
