// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <optional>
#include <string>
#include <vector>

#include "core/base/progress.h"
#include "core/scene/correction.h"
#include "core/scene/scene.h"
#include "core/surface/registration.h"

namespace glint {

/// Where a mesh that is not in the frame of its cameras belongs, by the sparse points of the capture.
struct MeshPlacement {
  std::string words;                     ///< for the finding: what was found, or why nothing was
  std::optional<Correction> correction;  ///< that moves the cameras to the mesh; none where the points do not determine it
};

/// @param mesh    the scene's only surface, in metres
/// @param points  that the cameras saw, in metres
/// A place from which not every camera that saw points would see the mesh is none. Stopped.
MeshPlacement placementOf(const Scene& scene, const TriangleMesh& mesh, const std::vector<SeenPoint>& points,
                          const ProgressFn& progress);

}  // namespace glint
