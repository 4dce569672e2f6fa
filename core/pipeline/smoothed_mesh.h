// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "core/model/model.h"

namespace glint {

/// A mesh that was smoothed because the highlights contradict it as it is given (light.smooth_mesh), and what led to it.
struct SmoothedMesh {
  std::string surface;  ///< key of the mesh; other surfaces stay
  std::shared_ptr<const Surface> mesh;
  double radius = 0;                  ///< of the vertices behind a quadric, world units
  double noise = 0, normalNoise = 0;  ///< as SmoothMesh
  std::optional<double> plainPx;  ///< what the light leaves of the training contours on the given mesh, RMS; none without a light
  double smoothPx = 0;            ///< the same on this one
  /// Tells the user the noise that was found, and what smoothing gained.
  std::string remark() const;
};

/// Chooses how much to smooth the mesh that all views of one light see. Radii grow by sqrt(2) from a few edges on; the light
/// that is estimated on each tells how well it explains the contours. The best one counts if it is clearly better than the mesh
/// as given. Empty where the given mesh explains the contours (nothing is tried then), no radius does clearly better, or
/// light.smooth_mesh is off.
/// @param views    on the mesh as given. @param plain  their light. @param surface  their key.
std::optional<SmoothedMesh> smoothedMesh(const std::vector<TrainingView>& views, const Outcome<LightEstimate>& plain,
                                         const std::string& surface, const Settings& settings);

}  // namespace glint
