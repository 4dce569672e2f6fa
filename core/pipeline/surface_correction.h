// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <memory>
#include <optional>

#include "core/light/refine_depth.h"
#include "core/pipeline/refined_normals.h"
#include "core/pipeline/smoothed_mesh.h"
#include "core/scene/scene.h"

namespace glint {

/// What a light's contours say of their surface: of depth maps or of a mesh, since a frame sees one of the two.
struct SurfaceCorrection {
  std::optional<DepthCorrection> depth;   ///< light.refine_depth: of every frame's own depth map
  std::optional<RefinedNormals> normals;  ///< light.refine_normals: of one mesh, smoothed before where `smoothed` says so
  std::optional<SmoothedMesh> smoothed;   ///< light.smooth_mesh: of one mesh
  explicit operator bool() const { return depth || normals || smoothed; }
};

/// The surface that a frame shows, corrected where the correction concerns it, else as given. A corrected depth map is read and
/// built anew at every call. NoSurface; FrameUnreadable for its depth image; InputError if a mesh cannot be read.
Outcome<std::shared_ptr<const Surface>> correctedSurface(const Scene& scene, const SurfaceCache& surfaces, int frame,
                                                         const SurfaceCorrection& correction, MeshPolicy policy);

/// Puts views on their corrected surfaces: brightest points, tangent planes and pixels anew. Views with `failure` stay as they
/// are; one whose surface is lost gets a failure.
void correctViews(std::vector<TrainingView>& views, const Scene& scene, const SurfaceCache& surfaces,
                  const SurfaceCorrection& correction, MeshPolicy policy);

}  // namespace glint
