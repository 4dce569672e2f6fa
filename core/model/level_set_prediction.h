// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <functional>
#include <optional>
#include <vector>

#include "core/model/model.h"

namespace glint {

/// A place where the field is smallest, with its value; `point` is what the highlight reports as its brightest point.
struct FieldPeak {
  BrightestPoint point;
  double value = 0;
};

/// A scalar field over the visible surface whose level set is a predicted contour: alpha, or -log I. Inside = value < level.
struct SurfaceField {
  /// Value at a visible point whose normal faces the camera; empty where it is undefined (unlit, not finite).
  std::function<std::optional<double>(const SurfacePoint& facingCamera)> value;
  double level = 0;
  std::vector<FieldPeak> peaks;  ///< known minima: seeds of the search and brightest points of the highlights
};

/// All components of { value < level } in the image, each followed beyond the border where the image cuts it (by
/// kMarginFraction), as highlights: outline, coverage (share of the outline on the level set or on the surface's own edge),
/// ellipse, brightest point. A component that encloses several minima is returned once (method.md section 8). Without a
/// component: OutsideImage where all known minima lie there, else NotReached.
Prediction predictLevelSet(const SurfaceField& field, const Camera& camera, const Surface& surface, const Settings& settings);

}  // namespace glint
