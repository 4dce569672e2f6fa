// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <string>

#include "core/base/outcome.h"
#include "core/inspect/inspection.h"

namespace glint {

/// The lobe that a scene as captured shows: the one that a synthesis of its contours starts from.
struct FittedLobe {
  Lobe lobe = Lobe::TorranceSparrow;
  double roughness = 0.1;  ///< m, > 0
  std::string origin;      ///< "reflectance, light lamp"; "limit angle 4.77° at level 0.5, light lamp"
};
/// That of the model reflectance where it was computed and fitted; else the width at which a Gaussian lobe falls to the contours'
/// level q at the light's limit angle, m = tan(alpha_lim) / sqrt(-log q), as Torrance-Sparrow.
/// @param frame  where there are several lights or surfaces, one of this frame comes first.
/// NotSupported if contours are synthesised (a fit would give back the lobe that made them), or if nothing was computed
/// that tells the lobe; else the reason why the fit failed.
Outcome<FittedLobe> fittedLobe(const Inspection& inspection, int frame);

}  // namespace glint
