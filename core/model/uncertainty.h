// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <functional>
#include <optional>
#include <vector>

#include "core/base/uncertainty.h"
#include "core/model/level_set_prediction.h"

namespace glint {

/// Derivative of (value - level) of a SurfaceField along each column of ParameterUncertainty::root, at a visible point whose
/// normal faces the camera: d value / d parameters times the root, in closed form or by differences. Empty where the value is.
using ColumnSlopes = std::function<std::optional<Eigen::VectorXd>(const SurfacePoint& facingCamera)>;

/// Shifts of a level set { value = level }, px along its normal and positive outwards (where the value rises), at each of its
/// points (rows) for each column of slopes, to first order: moving the parameters by d moves the curve by -(d value / d
/// parameters) d / |d value / d pixel|. The image gradient is a central difference over half a pixel (one-sided at the end of the
/// surface). A row of zeros at points that lie on the surface's own edge instead (more than half a pixel from the level), and
/// where the field is undefined.
Eigen::MatrixXd levelSetShiftsPx(const std::vector<Pixel>& points, const SurfaceField& field, const Camera& camera,
                                 const Surface& surface, const ColumnSlopes& slopes);

/// The same for a contour that is predicted point by point: one pair of polylines per column, predicted at plus and minus `step`
/// columns. The change across the contour of vertex i is that of vertex i where the polylines have equally many vertices (a
/// predicted direction keeps its number), else the distance along the normal to the perturbed polyline. Positive outwards.
Eigen::MatrixXd polylineShiftsPx(const Polyline& contour, const std::vector<std::pair<Polyline, Polyline>>& perturbed,
                                 double step);

/// Unit normals of a closed contour at its vertices, outwards; zero where neighbouring vertices coincide.
std::vector<Pixel> outwardNormals(const Polyline& contour);
/// Distance from each vertex along the outward normal to the nearest crossing of another contour; NaN where it misses that.
std::vector<double> shiftsAlongNormals(const Polyline& contour, const Polyline& other);

}  // namespace glint
