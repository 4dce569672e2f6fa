// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <optional>
#include <vector>

#include "core/base/settings.h"
#include "core/model/model.h"
#include "core/model/reconstruct.h"

namespace glint {

/// Where an ellipsoid's centre is expected, for `anchored` and as the prior of `refined`.
struct CentreAnchor {
  Eigen::Vector3d position;
  std::optional<Eigen::Matrix3d> covariance;  ///< m^2
};

/// The solver chosen by `fit.solver`, the same for the three ellipsoid models:
/// linear (centre free, >= 3 views), anchored (centre at the anchor, >= 2 views), refined (>= 3 views; starts at the linear
/// solution or, where that is no ellipsoid, at the anchored one; the anchor's covariance times fit.prior_scale^2 is the prior).
/// TooFewViews; NotAnEllipsoid (the linear solution's kind in the detail); NoLight (anchored without an anchor); the solver's own.
Outcome<Reconstruction> fitEllipsoid(const std::vector<ConicView>& views, const std::optional<CentreAnchor>& anchor,
                                     const Settings& settings);

/// Closest point to the viewing rays through the centres of the ellipses: the anchor of `primal`, which has no light.
/// Empty when the rays are parallel.
std::optional<CentreAnchor> anchorFromCentres(const std::vector<TrainingView>& views);

/// Copies a reconstruction into the fields of a fit.
void store(const Reconstruction& reconstruction, ModelFit& fit);

/// The ellipse as a polyline of `points` vertices, as a highlight without directions. @param brightest its peak.
PredictedHighlight highlightFromEllipse(const Ellipse& ellipse, const BrightestPoint& brightest, int points = 360);

}  // namespace glint
