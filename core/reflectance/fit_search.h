// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <vector>

#include "core/reflectance/fit.h"

namespace glint {

/// Lobe, lamp and roughness that explain the contours best: the lobe of the smallest residual. Every lobe is fitted; once the
/// best is known, every other one starts again from its light with the same width, until none gains. Where none explains the
/// contours well, the most promising starts of all lobes are tried. Where the residuals do not tell, a microfacet lobe is
/// taken: surfaces are rather microfacets than cosine powers. A sphere must lower the squared residuals by a fifth; for lamps
/// with a length see fitExtended.
/// @param lobes     at least one. With one only, another lobe may show the way to the light.
/// @param light     first guess
/// @param widthRad  of the lobe at the contours' level, as an angle theta_h (widthOf), in (0, pi / 2)
/// @return what fitRadiance returns; check `poor`.
Outcome<RadianceFit> searchRadiance(const std::vector<Lobe>& lobes, const std::vector<RadianceView>& views, const Light& light,
                                    double widthRad, const LampChoices& lamps, const RadianceFitOptions& options = {});

/// The same where a fit to nearly the same views is known, as for cameras that were moved a little: every lobe starts from its
/// lamp with the same width, and the lamp keeps its shape. This takes one solve for each lobe in place of a search.
/// @param near  lobe, roughness and lamp are read
Outcome<RadianceFit> fitNear(const std::vector<Lobe>& lobes, const std::vector<RadianceView>& views, const RadianceFit& near,
                             const RadianceFitOptions& options = {});

}  // namespace glint
