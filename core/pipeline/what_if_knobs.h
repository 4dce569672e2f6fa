// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <functional>
#include <string>
#include <vector>

#include "core/base/outcome.h"
#include "core/base/settings.h"
#include "core/pipeline/what_if.h"

namespace glint {

struct Inspection;

/// One number of a what-if, as a panel shows it.
struct WhatIfKnob {
  std::string group;                         ///< "Light lamp", "Camera of frame 0003", "Highlight 1 of frame 0003"
  ParamSpec spec;                            ///< key unique among the knobs; the default is the value that changes nothing
  bool synthetic = false;                    ///< counts only where contours are synthesised
  std::function<double(const WhatIf&)> get;  ///< in spec.unit
  std::function<void(WhatIf&, double)> set;  ///< a what-if whose knobs are all on their defaults is `none()` again
};

/// Knobs for the lights (those with a position), the surface, the lobe, the camera and the highlights of one frame.
/// @param highlights  how many the frame's evidence has.
/// @param roughness   m that a synthesis starts from, > 0: the default of that knob.
std::vector<WhatIfKnob> whatIfKnobs(const Scene& scene, int frame, int highlights, double roughness = WhatIf{}.roughness);

/// The lobe that a scene as captured shows: the one that a synthesis of its contours starts from.
struct FittedLobe {
  Lobe lobe = Lobe::TorranceSparrow;
  double roughness = 0.1;  ///< m, > 0
  std::string origin;      ///< "reflectance, light lamp"; "limit angle 4.77° at level 0.5, light lamp"
};
/// That of the model reflectance where it was computed and fitted; else the width at which a Gaussian lobe falls to the contours'
/// level q at the light's limit angle, m = tan(alpha_lim) / sqrt(-log q), as Torrance-Sparrow.
/// @param frame  where there are several lights or surfaces, one of this frame comes first.
/// NotSupported where contours are synthesised (a fit would give back the lobe that made them), or where nothing was computed
/// that tells the lobe; else the reason why the fit failed.
Outcome<FittedLobe> fittedLobe(const Inspection& inspection, int frame);

/// "contours synthesised, 1 light, 2 poses, 1 highlight"; "" for none.
std::string summaryOf(const WhatIf& whatIf);

/// What of a frame is not as it was captured, for the titles of its pictures: "contours and photograph synthesised, camera moved
/// by hand"; "" for a frame that nothing changes.
std::string frameNote(const WhatIf& whatIf, int frame);

}  // namespace glint
