// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <memory>
#include <string>
#include <utility>
#include <vector>

#include "core/base/settings.h"
#include "core/scene/scene.h"
#include "core/surface/surface.h"

namespace glint {

// What checkCameras() says where highlights and scene do not belong together, and what it looks at for that.

/// A camera centre, m, and the surface that its frame shows.
using EyeAndSurface = std::pair<Eigen::Vector3d, std::shared_ptr<const Surface>>;
/// Cameras from which the surface is seen whichever way one looks.
int insideOfSurfaces(const std::vector<EyeAndSurface>& views);

/// How many frames show no highlight; of all of them, why. @param searched  frames. @param dark  of them, without a highlight
std::string noHighlightText(const Scene& scene, const std::vector<int>& searched, int dark, const Settings& settings);

/// What no light explains, by what mirrored rays say.
struct Unexplained {
  int views = 0;
  double leftPx = 0, radiusPx = 0;  ///< by the best light; 0 without one
  double missRad = 0;               ///< by which mirrored rays pass the best lamp; pi without a lamp
  int beside = 0;                   ///< views whose highlights all lie beside the surface
  int inside = 0;                   ///< insideOfSurfaces()
  int mistakesTried = 0;
};
/// @param meets  rad: rays that pass the lamp by less share it
std::string nothingFitsText(const Unexplained& found, double meets);

/// @param share  of the contours' radius, without the noise of their points
std::string fitsPoorlyText(std::size_t frames, double leftPx, double share);

/// A frame whose highlight is not that of the lamp that the others share.
struct Outvoted {
  std::string frame;
  double missRad = 0;  ///< by which its mirrored ray passes the lamp; pi where its highlights lie beside the surface
};
/// @param frames  not empty. @param agreeing  how many frames share the lamp
std::string outvotedText(const std::vector<Outvoted>& frames, int agreeing);

}  // namespace glint
