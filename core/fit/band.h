// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <memory>
#include <string>
#include <vector>

#include "core/model/band.h"

namespace glint {

/// A fit's band (predict.band), and remarks about it, in words.
struct FittedBand {
  std::shared_ptr<const Band> band;  ///< null without one
  std::vector<std::string> remarks;
};

/// The band of a fit with its alternatives: the other lobes of a reflectance fit, reflectance beside the limit angle, each by the
/// share of evidence that its residuals leave it; and the fit repeated with the cameras that a scale or focal length off by its
/// stated tolerance (input.scale_tolerance, input.focal_tolerance) amounts to. A few fits; nothing is cached.
/// @param surfaceRefined  the views' surfaces are corrected depth maps or meshes
FittedBand bandOf(const HighlightModel& model, const ModelFit& fit, const FitInput& input, const Settings& settings,
                  bool surfaceRefined);

}  // namespace glint
