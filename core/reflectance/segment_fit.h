// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <optional>
#include <vector>

#include "core/reflectance/fit.h"

namespace glint {

/// A lamp with a length (method.md section 15), where the contours ask for one: tried where the plain fit leaves more than noise
/// and a length promises to lower its squared residuals by a fifth; taken where it keeps that promise, explains the contours, and
/// predicts left-out frames better than the plain fit does by more than the standard error.
/// @param lobes     those to try. @param plain  the best point or sphere, or null without one.
/// @param light     first guess, used where `plain` is null or poor. @param widthRad  as searchRadiance.
/// @return nothing where the contours do not ask for a length, or with fewer than three frames.
std::optional<RadianceFit> fitSegment(const std::vector<Lobe>& lobes, const std::vector<RadianceView>& views,
                                      const RadianceFit* plain, const Light& light, double widthRad,
                                      const RadianceFitOptions& options = {});

}  // namespace glint
