// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <Eigen/Core>
#include <optional>
#include <vector>

#include "core/light/estimate.h"

namespace glint {

/// The limit angle that one view's contour has by itself.
struct OwnWidth {
  double limitAngle = 0;                            ///< rad; 0 where fewer than five contour points are on the surface
  double sigma = 0;                                 ///< of its logarithm
  bool explained = false;                           ///< one angle describes most of the contour
  Eigen::Vector3d place = Eigen::Vector3d::Zero();  ///< middle of the contour on the object, which may move, m
  double sineSquared = 0;                           ///< of the light's incidence there
};

/// One light, under which the contour of every view lies at a limit angle of its own.
struct OwnWidths {
  Light light;
  std::vector<OwnWidth> views;      ///< in the order of the views
  double cost = 0, commonCost = 0;  ///< robust sums of squares; of the best light with one limit angle for all views
};

/// Minimises the robust spread of log alpha within each view over (l, w) on the unit sphere. The angle of a view needs no search:
/// it is the robust mean of its points. Views whose highlights have different widths pull a common bundle away from the light;
/// here they agree about it.
/// @param start  a first guess; lights where two reflected rays meet are others
/// @return nothing where the best light with one limit angle leaves too little for any view to differ, or where no light is on
///         the side of the surface that the views see
std::optional<OwnWidths> ownWidths(const std::vector<BundleView>& views, const std::optional<Light>& start,
                                   int pointsPerView = 72);

}  // namespace glint
