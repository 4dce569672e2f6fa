// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <optional>
#include <vector>

#include "core/reflectance/fit.h"

namespace glint {

/// A lamp with an extent (method.md section 15), where the contours ask for one: tried where the plain fit leaves more than
/// noise and a length promises to lower its squared residuals by a fifth; taken where it keeps that promise, explains the
/// contours, and predicts left-out frames better than the plain fit does by more than the standard error.
/// @param kind      whose startsOf() are searched
/// @param lobes     those to try. @param plain  the best fit of a simpler lamp, or null without one.
/// @param light     first guess, used where `plain` is null or poor. @param widthRad  as searchRadiance.
/// @return nothing where the contours do not ask for an extent, or with fewer than three frames.
std::optional<RadianceFit> fitExtended(const LampShape& kind, const std::vector<Lobe>& lobes,
                                       const std::vector<RadianceView>& views, const RadianceFit* plain, const Light& light,
                                       double widthRad, const RadianceFitOptions& options = {});

}  // namespace glint
