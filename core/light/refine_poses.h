// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <vector>

#include "core/light/estimate.h"

namespace glint {

struct PoseRefinement {
  Bundle bundle;                ///< with the refined cameras
  std::vector<Camera> cameras;  ///< one per view
  double movedPx = 0;           ///< RMS over views and axes of the correction, px at the surface
};

/// Light, limit angle and a small correction of every camera together: each view may turn by `sigmaPx` / f about each of its axes
/// and shift by `sigmaPx` Z / f along each (standard deviations of a Gaussian prior, Z its distance from the surface). Minimises
/// the robust sum of squared contour distances in pixels plus the prior, by Gauss-Newton steps on the joint Jacobian (QR), from a
/// bundle with the given cameras. Where the residuals of the plain bundle are white, or below 0.02 px, nothing speaks against the
/// poses and they stay as they are. The contours do not show what turns light and cameras alike (any rotation about a sphere's
/// centre), so nothing is gained there. The bundle's own failures.
Outcome<PoseRefinement> refinePoses(const std::vector<BundleView>& views, const Light& start, double sigmaPx,
                                    const BundleOptions& options = {});

}  // namespace glint
