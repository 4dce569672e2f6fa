// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <string>
#include <vector>

#include "core/base/image.h"
#include "core/geometry/camera.h"

namespace glint {

/// Depth of the same object, still in the world, from another place.
struct DepthView {
  std::string id;  ///< for reports
  Image depth;     ///< m, 0 = none, of the camera's size
  Camera camera;
};

/// Depth of one view with that of others averaged in.
struct FusedDepth {
  Image depth;                       ///< m; the pixels with depth are those of the view
  std::vector<std::string> used;     ///< views that were averaged in
  std::vector<std::string> refused;  ///< views whose depth lies elsewhere than the view's own: moved, bent, or a wrong pose
  std::vector<std::string> unseen;   ///< views with too little of the same surface to tell
  double disagreementM = 0;          ///< of the refused ones: the largest, m, root mean square over patches
};

/// Mean, along the view rays, of the surfaces that several depth maps show: as a signed distance that is truncated at `radius`
/// and averaged, at its zero. Every point of the view (smoothed by fittedDepth, with its normal) asks each other map for the
/// distance of the surface there along the normal; the weights are the inverse variances of a noise that grows as z^2 along the
/// other map's rays. The result contains the view's own depth with its noise, so smooth it afterwards. A view is refused
/// where the distances, averaged over patches of 16 x 16 pixels so that noise has little part in them, exceed both the noise of a
/// pixel and a thousandth of the depth: objects that move or bend by more than that between frames are not averaged, others are.
///
/// @param own     one channel; not finite or <= 0 = none.
/// @param radius  m, of the neighbourhood for fittedDepth; distances beyond it are another surface.
/// @see Curless and Levoy, A Volumetric Method for Building Complex Models from Range Images, SIGGRAPH 1996.
FusedDepth fusedDepth(const Image& own, const Camera& camera, const std::vector<DepthView>& others, double radius);

}  // namespace glint
