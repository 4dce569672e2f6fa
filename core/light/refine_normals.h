// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <Eigen/Core>
#include <functional>
#include <optional>
#include <vector>

#include "core/light/estimate.h"
#include "core/surface/mesh.h"

namespace glint {

/// What an angle on a contour should be, less a free constant: rad, at an ideal pixel of a view's contour. Nothing where it is
/// not known; the point is then left out.
using ContourAngle = std::function<std::optional<double>(std::size_t view, const Pixel&)>;

struct NormalRefinement {
  Light light;                  ///< with the corrected normals
  double limitAngle = 0;        ///< rad; of the constant alone where contours have angles of their own
  double plainRmsPx = 0;        ///< of the residuals with the normals as they are
  double rmsPx = 0;             ///< with the corrected ones
  NormalCorrection correction;  ///< changes nothing where nothing was refined
  double slope = 0;             ///< rad: RMS turn of the normal at the contours' points
  /// Standard deviation of a tilt that all contours share over that of its prior, in (0, 1]: 1 where the contours cannot tell it
  /// from a moved light.
  double openTilt = 1;
  /// The same as Bundle::uncertainty, with the normals' own uncertainty in it. Empty where nothing was refined.
  std::optional<ParameterUncertainty> uncertainty;
};

/// Light, limit angle and smooth bumps of one surface together. The bumps are a height over the surface whose gradient turns the
/// normals; positions stay. The height is a Gaussian process (squared exponential) whose slopes have one standard deviation in
/// every direction. Minimises the robust sum of squared contour distances in pixels plus that prior. Left-out views choose the
/// process: its length (half, once, twice or four times a highlight's size) and its steepness (sigma, a quarter or a sixteenth of
/// it). The flattest one that predicts them no worse than the best one by more than the standard error is taken, if it predicts
/// them better than the given normals do by more than that. Where the residuals with the given normals are white, or below 0.02
/// px, nothing speaks against the normals and they stay. A tilt that is alike in all views is nearly the same as a moved light:
/// openTilt tells.
/// @param views   all of one surface.
/// @param sigma   rad.
/// @param angles  what a model richer than one limit angle expects; empty: one limit angle.
/// TooFewPoints below 30 points on the surface; NotFinite; std::invalid_argument unless sigma > 0.
/// @see Rasmussen and Williams, Gaussian Processes for Machine Learning, 2006, sec. 9.4 (observations of derivatives).
Outcome<NormalRefinement> refineNormals(const std::vector<BundleView>& views, const Light& start, double sigma,
                                        const BundleOptions& options = {}, const ContourAngle& angles = {});

}  // namespace glint
