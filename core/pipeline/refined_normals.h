// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "core/light/refine_normals.h"
#include "core/model/model.h"

namespace glint {

/// A mesh with corrected normals, and what led to it (light.refine_normals).
struct RefinedNormals {
  std::string surface;                  ///< key of the mesh that was corrected; other surfaces stay
  std::shared_ptr<const Surface> mesh;  ///< the corrected one
  std::string model;                  ///< whose contours told: levelSetModel() or radianceModel(), whichever explains them better
  double slope = 0, openTilt = 1;     ///< as NormalRefinement
  double plainPx = 0, refinedPx = 0;  ///< what the model leaves of the training contours before and after, RMS
  std::optional<ParameterUncertainty> uncertainty;  ///< of the limit angle's light, where that model told
  /// Tells the user how far the normals turned, what it gained and what stays open.
  std::string remark() const;
};

/// Corrects the mesh that all views of one light see. Bumps are what neither limit angle nor reflectance model explains. The
/// better model tells the angle along each contour (refineNormals), and must fit the corrected mesh better. Empty without a gain.
/// @param views    with their light as estimated. @param surface  their key.
/// NotSupported unless `light.solver` is bundle and the mesh has vertex normals; the failures of refineNormals().
Outcome<std::optional<RefinedNormals>> refineNormals(const std::vector<TrainingView>& views, const LightEstimate& light,
                                                     const std::string& surface, const Settings& settings);

/// A training view on another surface, which stands where the scene has it: brightest point, tangent plane and pixels anew.
/// `canonical` is left to the caller.
TrainingView onSurface(const TrainingView& view, std::shared_ptr<const Surface> surface);

}  // namespace glint
