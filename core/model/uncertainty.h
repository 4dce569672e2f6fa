// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <functional>
#include <optional>
#include <vector>

#include "core/base/uncertainty.h"
#include "core/model/model.h"
#include "core/surface/level_set.h"

namespace glint {

/// Derivative of (field - level) along each column of ParameterUncertainty::root, at a pixel; empty where the field is undefined.
using ColumnSlopes = std::function<std::optional<Eigen::VectorXd>(const Pixel&)>;

/// Standard deviation across a level set { field = level }, px, at each of its points, to first order: moving the parameters by d
/// moves the curve by -(d field / d parameters) d / |d field / d pixel| along its normal, so that
/// sigma = |slopes| / |d field / d pixel|. The image gradient is a central difference over `stepPx` (one-sided at the end of the surface).
/// 0 at points that lie on the surface's own edge instead (more than half a pixel from the level), and where the field is undefined.
std::vector<double> levelSetSigmaPx(const std::vector<Pixel>& points, const PixelField& field, double level, const ColumnSlopes& slopes,
                                    double stepPx = 0.5);

/// The same for a contour that is predicted point by point: one pair of polylines per column, predicted at plus and minus `step` columns.
/// The change across the contour of vertex i is that of vertex i where the polylines have equally many vertices (a predicted direction keeps
/// its number), else the distance along the normal to the perturbed polyline.
std::vector<double> polylineSigmaPx(const Polyline& contour, const std::vector<std::pair<Polyline, Polyline>>& perturbed, double step);

/// HighlightModel::bandSigmaPx of the ellipsoid models: predicts again with the centre, shape (and light) moved along each column.
std::vector<double> ellipsoidBandSigmaPx(const HighlightModel& model, const ModelFit& fit, const PredictedHighlight& highlight,
                                         const Camera& camera, const Surface* surface, const Settings& settings);

}  // namespace glint
