// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <functional>
#include <optional>
#include <vector>

#include "core/base/uncertainty.h"
#include "core/model/level_set_prediction.h"

namespace glint {

/// Derivative of (value - level) of a SurfaceField along each column of ParameterUncertainty::root, at a visible point whose normal
/// faces the camera: d value / d parameters times the root, in closed form or by differences. Empty where the value is.
using ColumnSlopes = std::function<std::optional<Eigen::VectorXd>(const SurfacePoint& facingCamera)>;

/// Standard deviation across a level set { value = level }, px, at each of its points, to first order: moving the parameters by d
/// moves the curve by -(d value / d parameters) d / |d value / d pixel| along its normal, so that
/// sigma = |slopes| / |d value / d pixel|. The image gradient is a central difference over half a pixel (one-sided at the end of the surface).
/// 0 at points that lie on the surface's own edge instead (more than half a pixel from the level), and where the field is undefined.
std::vector<double> levelSetSigmaPx(const std::vector<Pixel>& points, const SurfaceField& field, const Camera& camera,
                                    const Surface& surface, const ColumnSlopes& slopes);

/// The same for a contour that is predicted point by point: one pair of polylines per column, predicted at plus and minus `step` columns.
/// The change across the contour of vertex i is that of vertex i where the polylines have equally many vertices (a predicted direction keeps
/// its number), else the distance along the normal to the perturbed polyline.
std::vector<double> polylineSigmaPx(const Polyline& contour, const std::vector<std::pair<Polyline, Polyline>>& perturbed, double step);

/// HighlightModel::bandSigmaPx of the ellipsoid models: predicts again with the centre, shape (and light) moved along each column.
std::vector<double> ellipsoidBandSigmaPx(const HighlightModel& model, const ModelFit& fit, const PredictedHighlight& highlight,
                                         const Camera& camera, const Surface* surface, const Settings& settings);

}  // namespace glint
